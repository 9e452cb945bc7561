// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/blade_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/operations/cut_along.hpp"
#include "kernel/parts/embedding.hpp"
#include "suture/plugin.h"

namespace suture {
namespace {

constexpr double tolerance_in_edges = 0.02;

}  // namespace

BladePieces::BladePieces(const CellComplex& complex, const Parts& parts, const double* rows,
                         const Blade& blade, const std::string& path, std::size_t stride)
    : complex_(complex),
      materials_(parts),
      rows_(rows),
      blade_(blade),
      path_(path),
      stride_(stride),
      heights_(blade.heights(complex, rows, stride)),
      side_(complex.element_count(), 0),
      pieces_of_(complex.element_count(), {none, none}) {
  find_sides();
  pieces_.reserve(4 * crossed_.size());
  for (const Index e : crossed_) divide(e);
}

/// The tolerance is one for all, so that neighbours agree: that of the shortest edge at the
/// blade.
void BladePieces::find_sides() {
  std::vector<Index> near;
  double shortest = std::numeric_limits<double>::infinity();
  for (Index e = 0; e < complex_.element_count(); ++e) {
    if (!complex_.exists(3, e)) continue;
    const Hexahedron& nodes = complex_.vertices_of(e);
    if (std::isnan(heights_[nodes[0]])) continue;  // far away, as below
    double low = heights_[nodes[0]], high = low, sum = 0;
    for (const Index v : nodes) {
      low = std::min(low, heights_[v]);
      high = std::max(high, heights_[v]);
      sum += heights_[v];
    }
    if (std::isnan(sum)) continue;  // far away; it touches no divided one
    side_[e] = high > -low ? 1 : -1;
    // Corners on a plane along a grid are beside it by rounding.
    if (std::min(high, -low) < -tolerance_in_edges * (high - low)) continue;
    near.push_back(e);
    for (const auto& [a, b] : hexahedron::edge_vertices) {
      const Vec3 edge = minus(row(nodes[a]), row(nodes[b]));
      shortest = std::min(shortest, dot(edge, edge));
    }
  }
  tolerance_ = tolerance_in_edges * std::sqrt(shortest);
  for (const Index e : near) {
    bool above = false, below = false;
    for (const Index v : complex_.vertices_of(e)) {
      above = above || heights_[v] > tolerance_;
      below = below || heights_[v] < -tolerance_;
    }
    if (above && below) crossed_.push_back(e);
  }
  materials_.find_surface(crossed_, complex_.element_count());
}

double BladePieces::height_at(const Hexahedron& nodes, const Vec3& at) const {
  const std::array<double, 8> weights = trilinear_weights(at);
  double height = 0;
  for (std::size_t n = 0; n < 8; ++n)
    if (weights[n] != 0) height += weights[n] * heights_[nodes[n]];
  return height;
}

void BladePieces::divide(Index element) {
  const Hexahedron& nodes = complex_.vertices_of(element);
  Material own;
  const Material& material = materials_.of(element, own);
  std::vector<double>& heights = point_heights_;
  heights.clear();
  for (const Vec3& at : material.points) heights.push_back(height_at(nodes, at));
  side_[element] = static_cast<std::int8_t>(side_of(material, heights, tolerance_));
  if (side_[element] == 0 && blade_.has_divided(element, heights_)) {
    // Its section is linear in each tetrahedron, heights are not.
    const auto [low, high] = std::ranges::minmax(heights);
    side_[element] = high > -low ? 1 : -1;
  }
  if (side_[element] != 0) return;
  std::vector<DividedPart> found = divider_.divide(material, heights, tolerance_);
  if (found.size() < 2 || !is_held(nodes, found)) return;
  const auto first = static_cast<Index>(pieces_.size());
  for (DividedPart& part : found) {
    if (part.material.tetrahedra.size() > max_fragments)
      throw NumericalError(path_ + ": a part of an element would consist of " +
                           std::to_string(part.material.tetrahedra.size()) +
                           " tetrahedra; the limit is " + std::to_string(max_fragments) +
                           ". Cut less often there, or use smaller elements");
    BladePiece& piece = pieces_.emplace_back(BladePiece{element, part.side, std::move(part), {}});
    piece.own_triangles.emplace(piece.part.material);
  }
  pieces_of_[element] = {first, static_cast<Index>(pieces_.size())};
  divided_.push_back(element);
}

/// Whether the blade holds the whole section.
bool BladePieces::is_held(const Hexahedron& nodes, const std::vector<DividedPart>& found) const {
  if (blade_.is_endless()) return true;
  for (const DividedPart& part : found)
    for (const Vec3& at : part.material.points)
      if (std::abs(height_at(nodes, at)) <= tolerance_ &&
          !blade_.holds(place_in(nodes, at, rows_, stride_)))
        return false;
  return true;
}

BladePieces::Range BladePieces::of(Index element) {
  Range& range = pieces_of_[element];
  if (range.first == none) {
    range.first = static_cast<Index>(pieces_.size());
    BladePiece& piece = pieces_.emplace_back(BladePiece{element, side_[element], {}, {}});
    Material own;
    if (materials_.is_part(element)) piece.own_triangles.emplace(materials_.of(element, own));
    range.last = range.first + 1;
  }
  return range;
}

bool BladePieces::holds_face(Index element, int face) const {
  if (blade_.is_endless()) return true;
  Vec3 middle{};
  for (const auto n : suture_hexahedron_faces[face])
    middle = plus(middle, scaled(0.25, row(complex_.vertices_of(element)[n])));
  return blade_.holds(middle);
}

}  // namespace suture
