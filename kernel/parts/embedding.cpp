// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/embedding.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <unordered_map>

#include "kernel/parts/cube_sides.hpp"

namespace suture {
namespace {

/// The nodes on which a point depends and their weights, ascending; unused places are `none`.
/// Points on edges and faces are the same if these are; one within an element depends on all eight
/// nodes, and is alone.
using Support = std::array<std::pair<Index, double>, 4>;

Support support_of(const EmbeddedPoint& point, const CellComplex& complex) {
  Support support;
  support.fill({none, 0});
  const std::array<double, 8> weights = trilinear_weights(point.at);
  if (std::ranges::count(weights, 0.0) < 4) return support;
  std::size_t used = 0;
  for (std::size_t n = 0; n < 8; ++n)
    if (weights[n] != 0) support[used++] = {complex.vertices_of(point.element)[n], weights[n]};
  std::ranges::sort(support);
  return support;
}

struct HashOfSupport {
  std::size_t operator()(const Support& support) const {
    std::uint64_t hash = 0;
    for (const auto& [vertex, weight] : support)
      hash = (hash ^ vertex ^ std::bit_cast<std::uint64_t>(weight)) * 0x9E3779B97F4A7C15u;
    return hash ^ hash >> 32;
  }
};

/// Joins points that have the same support, and numbers them in the order of their first.
class Welding {
 public:
  explicit Welding(const CellComplex& complex) : complex_(complex) {}

  /// Returns the number by which place() knows the point.
  Index add(const EmbeddedPoint& point) {
    points_.push_back(point);
    return static_cast<Index>(points_.size() - 1);
  }

  EmbeddedPoints weld() {
    EmbeddedPoints welded;
    std::unordered_map<Support, Index, HashOfSupport> known(points_.size());
    place_.reserve(points_.size());
    for (const EmbeddedPoint& point : points_) {
      const Support support = support_of(point, complex_);
      const auto number = static_cast<Index>(welded.size());
      const bool is_alone = support[0].first == none;
      place_.push_back(is_alone ? number : known.try_emplace(support, number).first->second);
      if (place_.back() == number) add_to(welded, point);
    }
    return welded;
  }

  /// After weld().
  template <std::size_t N>
  void replace(std::vector<std::array<Index, N>>& cells) const {
    for (auto& cell : cells)
      for (Index& corner : cell) corner = place_[corner];
  }

 private:
  void add_to(EmbeddedPoints& welded, const EmbeddedPoint& point) const {
    const std::array<double, 8> weights = trilinear_weights(point.at);
    for (std::size_t n = 0; n < 8; ++n) {
      if (weights[n] == 0) continue;
      welded.vertices.push_back(complex_.vertices_of(point.element)[n]);
      welded.weights.push_back(weights[n]);
    }
    welded.first.push_back(static_cast<Index>(welded.vertices.size()));
  }

  const CellComplex& complex_;
  std::vector<EmbeddedPoint> points_;
  std::vector<Index> place_;
};

/// Collects the cells of an embedding; their corners are numbers of a Welding until the end.
class EmbeddingBuilder {
 public:
  EmbeddingBuilder(const Parts& parts, const CellComplex& complex, Embedding& out)
      : parts_(parts),
        complex_(complex),
        out_(out),
        welding_(complex),
        added_(parts.points.size(), none) {}

  void build() {
    for (std::size_t t = 0; t < parts_.triangles.size(); ++t) add_triangle(t);
    std::size_t next = 0;
    for (Index e = 0; e < complex_.element_count(); ++e) {
      const bool is_partial = next < parts_.elements.size() && parts_.elements[next] == e;
      if (complex_.exists(3, e)) is_partial ? add_part(next) : add_open_faces(e);
      next += is_partial ? 1 : 0;
    }
    out_.points = welding_.weld();
    welding_.replace(out_.tetrahedra);
    welding_.replace(out_.triangles);
  }

 private:
  Index point(Index p) {
    if (added_[p] == none) added_[p] = welding_.add(parts_.points[p]);
    return added_[p];
  }
  void add_triangle(Index element, const std::array<Index, 3>& corners, bool is_laid_open) {
    out_.triangles.push_back(corners);
    out_.triangle_element.push_back(element);
    out_.is_laid_open.push_back(is_laid_open ? 1 : 0);
  }

  /// Adds a triangle of the parts. Those on an open side of their element come with the others
  /// there.
  void add_triangle(std::size_t t) {
    const auto& [a, b, c] = parts_.triangles[t];
    const Index element = parts_.points[a].element;
    if (!complex_.exists(3, element)) return;
    const auto at = [&](Index p) { return sides_at(parts_.points[p].at); };
    const unsigned sides = at(a) & at(b) & at(c);
    for (std::size_t i = 0; i < cube_sides.size(); ++i)
      if ((sides >> i & 1) != 0 && is_open(element, cube_sides[i])) return;
    add_triangle(element, {point(a), point(b), point(c)},
                 !parts_.is_cut.empty() && parts_.is_cut[t] != 0);
  }

  void add_part(std::size_t i) {
    const Index element = parts_.elements[i];
    for (Index t = parts_.first[i]; t < parts_.first[i + 1]; ++t) {
      const auto& c = parts_.tetrahedra[t];
      out_.tetrahedra.push_back({point(c[0]), point(c[1]), point(c[2]), point(c[3])});
      out_.tetrahedron_element.push_back(element);
      for (const CubeSide side : cube_sides)
        if (is_open(element, side)) add_open_faces(element, c, side);
    }
  }
  /// Those of a tetrahedron that lie on a side of its element.
  void add_open_faces(Index element, const std::array<Index, 4>& corners, CubeSide side) {
    for (const auto& [a, b, c] : tetrahedron_faces) {
      const auto lies = [&](unsigned i) {
        return parts_.points[corners[i]].at[side.axis] == side.place();
      };
      if (lies(a) && lies(b) && lies(c))
        add_triangle(element, {point(corners[a]), point(corners[b]), point(corners[c])},
                     is_laid_open(element, side));
    }
  }
  /// Those of a full element.
  void add_open_faces(Index element) {
    for (const CubeSide side : cube_sides) {
      if (!is_open(element, side)) continue;
      std::array<Index, 4> q;
      const auto corners = corners_of(side);
      for (std::size_t i = 0; i < 4; ++i) q[i] = welding_.add({element, corner_place(corners[i])});
      add_triangle(element, {q[0], q[1], q[2]}, is_laid_open(element, side));
      add_triangle(element, {q[0], q[2], q[3]}, is_laid_open(element, side));
    }
  }
  bool is_laid_open(Index element, CubeSide side) const {
    return parts_.outer_sides.empty() || (parts_.outer_sides[element] >> side.face() & 1) == 0;
  }
  bool is_open(Index element, CubeSide side) const {
    return complex_.neighbour(element, side.face()) == none;
  }

  const Parts& parts_;
  const CellComplex& complex_;
  Embedding& out_;
  Welding welding_;
  std::vector<Index> added_;  ///< by point of the parts
};

}  // namespace

Parts renumbered(Parts parts, const Renumbering& element_of) {
  if (element_of.list().empty()) return parts;
  for (EmbeddedPoint& point : parts.points) point.element = element_of[point.element];
  std::vector<std::size_t> order(parts.elements.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return element_of[parts.elements[i]]; });
  Parts result;
  result.points = std::move(parts.points);
  result.triangles = std::move(parts.triangles);
  result.is_cut = std::move(parts.is_cut);
  result.first.push_back(0);
  for (const std::size_t i : order) {
    result.elements.push_back(element_of[parts.elements[i]]);
    result.moments.push_back(parts.moments[i]);
    result.tetrahedra.insert(result.tetrahedra.end(), parts.tetrahedra.begin() + parts.first[i],
                             parts.tetrahedra.begin() + parts.first[i + 1]);
    result.first.push_back(static_cast<Index>(result.tetrahedra.size()));
  }
  return result;
}

std::array<double, 8> trilinear_weights(const Vec3& at) {
  std::array<double, 8> weights;
  for (std::size_t n = 0; n < 8; ++n) {
    weights[n] = 1;
    for (std::size_t a = 0; a < 3; ++a)
      weights[n] *= ((n >> a & 1) != 0 ? 1 + at[a] : 1 - at[a]) / 2;
  }
  return weights;
}

Vec3 place_in(const Hexahedron& nodes, const Vec3& at, const double* rows, std::size_t stride) {
  const std::array<double, 8> weights = trilinear_weights(at);
  Vec3 place{};
  for (std::size_t n = 0; n < 8; ++n)
    for (std::size_t a = 0; a < 3; ++a) place[a] += weights[n] * rows[stride * nodes[n] + a];
  return place;
}

Embedding::Embedding(const Parts& parts, const CellComplex& complex) {
  if (!parts.empty() || !parts.outer_sides.empty()) EmbeddingBuilder(parts, complex, *this).build();
}

}  // namespace suture
