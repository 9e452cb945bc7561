// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/blade_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/base/box.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/operations/cut_along.hpp"
#include "kernel/parts/embedding.hpp"
#include "suture/plugin.h"

namespace suture {
namespace {

constexpr double tolerance_in_edges = 0.02;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// The height at a place: linear in each tetrahedron of the cube, so that a blade is a plane there.
/// With x_a >= x_b >= x_c in [0, 1]^3, the tetrahedron has the corners 0, a, a + b, a + b + c, and
///   h(x) = (1 - x_a) h_0 + (x_a - x_b) h_a + (x_b - x_c) h_ab + x_c h_abc.
/// On a face, only the heights of its nodes count: both sides find the same bits.
double height_at(const std::array<double, 8>& heights, const Vec3& at) {
  std::array<unsigned, 3> axes{0, 1, 2};
  std::ranges::sort(axes,
                    [&](unsigned a, unsigned b) { return at[a] != at[b] ? at[a] > at[b] : a < b; });
  double height = 0, before = 1;
  unsigned corner = 0;
  const auto add = [&](double weight) {
    if (weight != 0) height += weight * heights[corner];
  };
  for (const unsigned a : axes) {
    const double x = (1 + at[a]) / 2;
    add(before - x);
    before = x;
    corner |= 1u << a;
  }
  add(before);
  return height;
}

}  // namespace

BladePieces::BladePieces(const CellComplex& complex, const Parts& parts, const double* rows,
                         const Blade& blade, std::size_t stride)
    : complex_(complex),
      materials_(parts),
      rows_(rows),
      blade_(blade),
      stride_(stride),
      heights_(blade.heights(complex, rows, stride)),
      side_(complex.element_count(), 0),
      pieces_of_(complex.element_count(), {none, none}) {
  find_sides();
  pieces_.reserve(4 * crossed_.size());
  for (const Index e : crossed_) divide(e);
  refine_beside_divided();
}

/// The tolerance is one for all, so that neighbours agree: that of the shortest edge at the
/// blade.
void BladePieces::find_sides() {
  double shortest = infinity;
  for (Index e = 0; e < complex_.element_count(); ++e) {
    if (!complex_.exists(3, e)) continue;
    const Hexahedron& nodes = complex_.vertices_of(e);
    // Heights that are not known, most of them if the blade is short, are never less or greater.
    double low = infinity, high = -infinity, sum = 0;
    for (const Index v : nodes) {
      low = std::min(low, heights_[v]);
      high = std::max(high, heights_[v]);
      sum += heights_[v];
    }
    if (std::isnan(sum)) {  // it cannot be divided, but it may be beside one that is
      if (low < 0 && high > 0) leave_whole(e);
      continue;
    }
    side_[e] = high > -low ? 1 : -1;
    // Corners on a plane along a grid are beside it by rounding.
    if (std::min(high, -low) < -tolerance_in_edges * (high - low)) continue;
    near_.push_back(e);
    for (const auto& [a, b] : hexahedron::edge_vertices) {
      const Vec3 edge = minus(row(nodes[a]), row(nodes[b]));
      shortest = std::min(shortest, dot(edge, edge));
    }
  }
  tolerance_ = tolerance_in_edges * std::sqrt(shortest);
  for (const Index e : near_) {
    bool above = false, below = false;
    for (const Index v : complex_.vertices_of(e)) {
      above = above || heights_[v] > tolerance_;
      below = below || heights_[v] < -tolerance_;
    }
    if (above && below) crossed_.push_back(e);
  }
  std::vector<Index> seen = crossed_;
  seen.insert(seen.end(), undivided_.begin(), undivided_.end());
  materials_.find_surface(seen, complex_.element_count());
}

BladePieces::NodeHeights BladePieces::node_heights(const Hexahedron& nodes) const {
  NodeHeights heights;
  for (std::size_t n = 0; n < 8; ++n) heights[n] = heights_[nodes[n]];
  return heights;
}

void BladePieces::find_point_heights(const Material& material, const NodeHeights& heights) {
  point_heights_.clear();
  for (const Vec3& at : material.points) point_heights_.push_back(height_at(heights, at));
}

void BladePieces::divide(Index element) {
  const Hexahedron& nodes = complex_.vertices_of(element);
  const Material& material = materials_.of(element, own_);
  find_point_heights(material, node_heights(nodes));
  const std::vector<double>& heights = point_heights_;
  side_[element] = static_cast<std::int8_t>(side_of(material, heights, tolerance_));
  if (side_[element] != 0) return undivided_.push_back(element);
  const Blade::Earlier earlier = blade_.earlier_cut(element, heights_);
  if (earlier != Blade::Earlier::never) {
    // Its section is linear in each tetrahedron, heights are not.
    const auto [low, high] = std::ranges::minmax(heights);
    if (earlier == Blade::Earlier::here) side_[element] = high > -low ? 1 : -1;
    return leave_whole(element);
  }
  std::vector<DividedPart> found = divider_.divide(material, heights, tolerance_);
  if (found.size() < 2 || !is_opened(nodes, material, found)) return leave_whole(element);
  const auto first = static_cast<Index>(pieces_.size());
  for (DividedPart& part : found) {
    BladePiece& piece = pieces_.emplace_back(BladePiece{element, part.side, std::move(part), {}});
    piece.own_triangles.emplace(piece.part.material);
  }
  pieces_of_[element] = {first, static_cast<Index>(pieces_.size())};
  divided_.push_back(element);
}

/// Adds the area of the section, too.
bool BladePieces::is_opened(const Hexahedron& nodes, const Material& material,
                            const std::vector<DividedPart>& found) {
  const bool is_opened = is_held(nodes, found);
  if (!blade_.is_measured()) return is_opened;
  for (const auto& tetrahedron : material.tetrahedra) {
    std::array<Vec3, 4> corners;
    std::array<double, 4> heights;
    for (std::size_t i = 0; i < 4; ++i) {
      corners[i] = place_in(nodes, material.points[tetrahedron[i]], rows_, stride_);
      heights[i] = point_heights_[tetrahedron[i]];
    }
    const Section section = section_of(corners, heights, tolerance_);
    for (std::size_t t = 0; t < section.count; ++t) measure(section.triangles[t], is_opened);
  }
  return is_opened;
}

void BladePieces::measure(const Corners3& triangle, bool is_opened) {
  const auto holds = [&](const Vec3& place) { return blade_.holds(place, 0); };
  if (is_opened) area_.opened += area_of(triangle);
  area_.blade += held_area(triangle, holds);
}

/// Whether the blade holds the whole section.
bool BladePieces::is_held(const Hexahedron& nodes, const std::vector<DividedPart>& found) const {
  if (blade_.is_endless()) return true;
  const NodeHeights heights = node_heights(nodes);
  for (const DividedPart& part : found)
    for (const Vec3& at : part.material.points)
      if (std::abs(height_at(heights, at)) <= tolerance_ &&
          !blade_.holds(place_in(nodes, at, rows_, stride_), tolerance_))
        return false;
  return true;
}

/* A blade that ends in the body leaves elements whole that share edges and faces with divided ones.
 * Their tetrahedra are clipped there, too, or later cuts would find other triangles on the two
 * sides of a face. Nodes of divided elements have their heights, all others lie on the blade: the
 * clip ends within one element.
 *
 *      +------+------+------+
 *      |      |      |    / |      d: divided
 *      +------+------+--/---+      r: refined; its lower nodes are on the blade
 *      |  d   |  d   |/ r   |
 *      +------+------+------+
 */
void BladePieces::refine_beside_divided() {
  if (divided_.empty() || !has_rim_) return;
  NodesByPlace divided;
  for (const Index e : divided_)
    for (const Index v : complex_.vertices_of(e)) divided.push_back({row(v), v});
  sort_unique(divided);
  std::ranges::sort(undivided_);
  add_other_lips(divided);
  PartWriter writer(refined_.parts);
  for (const Index e : undivided_) {
    NodeHeights heights;
    std::ranges::transform(complex_.vertices_of(e), heights.begin(),
                           [&](Index v) { return rim_height(divided, v); });
    const auto [low, high] = std::ranges::minmax(heights);
    if (low < -tolerance_ && high > tolerance_) refine(e, heights, writer);
  }
}

/// Adds the elements at vertices in the places of divided ones that have other heights: where a
/// moving blade crosses its own slit, such an element may be on one side by its own heights.
void BladePieces::add_other_lips(const NodesByPlace& divided) {
  Box box = no_box;
  for (const auto& [place, v] : divided) include(box, place);
  std::vector<bool> is_other(heights_.size());
  bool has_other = false;
  for (Index v = 0; v < heights_.size(); ++v) {
    if (std::isnan(heights_[v]) || !contains(box, row(v))) continue;
    const auto at = std::ranges::lower_bound(divided, std::pair(row(v), Index{0}));
    is_other[v] = at != divided.end() && at->first == row(v) && heights_[at->second] != heights_[v];
    has_other = has_other || is_other[v];
  }
  if (!has_other) return;
  std::vector<Index> more;
  for (Index e = 0; e < complex_.element_count(); ++e)
    if (complex_.exists(3, e) &&
        std::ranges::any_of(complex_.vertices_of(e), [&](Index v) { return is_other[v]; }) &&
        !std::ranges::binary_search(crossed_, e) && !std::ranges::binary_search(undivided_, e))
      more.push_back(e);
  materials_.find_surface(more, complex_.element_count());
  undivided_.insert(undivided_.end(), more.begin(), more.end());
  std::ranges::sort(undivided_);
}

/// That of a node of divided elements. The other parts of an element have nodes at the same places,
/// and at another time a moving blade may have given them other heights.
double BladePieces::rim_height(const NodesByPlace& divided, Index vertex) const {
  const Vec3 place = row(vertex);
  if (std::ranges::binary_search(divided, std::pair(place, vertex))) return heights_[vertex];
  const auto other = std::ranges::lower_bound(divided, std::pair(place, Index{0}));
  return other != divided.end() && other->first == place ? heights_[other->second] : 0;
}

void BladePieces::refine(Index element, const NodeHeights& heights, PartWriter& writer) {
  std::vector<Index> numbers;
  const Material material = materials_.with_surface(element, numbers);
  find_point_heights(material, heights);
  const RefinedMaterial refined = divider_.refine(material, point_heights_, tolerance_);
  if (refined.material.tetrahedra.size() == material.tetrahedra.size()) return;
  const Index first = writer.add_volume(element, refined.material);
  for (std::size_t t = 0; t < refined.sources.size(); ++t) {
    writer.add_triangle(first, refined.material.triangles[t], refined.material.is_cut[t] != 0);
    refined_.sources.push_back(numbers[refined.sources[t]]);
  }
  writer.end_copy(element, materials_.moments_of(element));
  add_whole(element);
  pieces_.back().own_triangles.emplace(refined.material);
}

BladePieces::Range BladePieces::of(Index element) {
  if (pieces_of_[element].first == none) {
    add_whole(element);
    Material own;
    if (materials_.is_part(element))
      pieces_.back().own_triangles.emplace(materials_.of(element, own));
  }
  return pieces_of_[element];
}

void BladePieces::add_whole(Index element) {
  const auto piece = static_cast<Index>(pieces_.size());
  pieces_.push_back({element, side_[element], {}, {}});
  pieces_of_[element] = {piece, piece + 1};
}

bool BladePieces::opens_face(Index element, int face) {
  if (blade_.is_endless()) return true;
  std::array<Vec3, 4> corners;
  Vec3 middle{};
  for (std::size_t k = 0; k < 4; ++k) {
    corners[k] = row(complex_.vertices_of(element)[suture_hexahedron_faces[face][k]]);
    middle = plus(middle, scaled(0.25, corners[k]));
  }
  const bool is_opened = blade_.holds(middle, tolerance_);
  if (blade_.is_measured()) {
    measure({corners[0], corners[1], corners[2]}, is_opened);
    measure({corners[0], corners[2], corners[3]}, is_opened);
  }
  return is_opened;
}

}  // namespace suture
