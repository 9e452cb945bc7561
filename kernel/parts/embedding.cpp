// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/embedding.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <utility>

#include "kernel/parts/cube_sides.hpp"

namespace suture {
namespace {

/// Collects points. Those on edges and faces of elements are the same if the vertices on which they
/// depend and their weights are; one within an element depends on all eight nodes, and is alone.
class Welding {
 public:
  Welding(const CellComplex& complex, std::size_t expected, EmbeddedPoints& out)
      : complex_(complex),
        out_(out),
        number_of_(complex.count(0), none),
        table_(std::bit_ceil(expected / 2 + 2), none) {
    out.first.reserve(expected + 1);
    out.vertices.reserve(4 * expected);
    out.weights.reserve(4 * expected);
  }

  /// Returns the number of the point, which is new or not.
  Index add(const EmbeddedPoint& point) {
    const std::array<double, 8> weights = trilinear_weights(point.at);
    const Hexahedron& nodes = complex_.vertices_of(point.element);
    for (std::size_t n = 0; n < 8; ++n) {
      if (weights[n] == 0) continue;
      out_.vertices.push_back(nodes[n]);
      out_.weights.push_back(weights[n]);
    }
    const std::size_t used = out_.vertices.size() - out_.first.back();
    return used == 1   ? finish(number_of_[out_.vertices.back()])
           : used == 8 ? finish()
                       : finish(place_of_last());
  }
  Index add(Index vertex) {
    if (number_of_[vertex] != none) return number_of_[vertex];
    out_.vertices.push_back(vertex);
    out_.weights.push_back(1);
    return number_of_[vertex] = finish();
  }

 private:
  Index next() const { return static_cast<Index>(out_.size()); }

  /// The point that has been written last becomes a new one,
  Index finish() {
    out_.first.push_back(static_cast<Index>(out_.vertices.size()));
    return next() - 1;
  }
  /// unless `known` is its number.
  Index finish(Index& known) {
    if (known == none) return known = finish();
    out_.vertices.resize(out_.first.back());
    out_.weights.resize(out_.first.back());
    return known;
  }

  /// Where the number of a point like that which has been written last is, or comes to.
  Index& place_of_last() {
    if (2 * in_table_ >= table_.size()) grow();
    const Index begin = out_.first.back(), end = static_cast<Index>(out_.vertices.size());
    for (std::size_t i = hash(begin, end);; ++i) {
      Index& place = table_[i & (table_.size() - 1)];
      if (place == none) ++in_table_;
      if (place == none || are_equal(place, begin, end)) return place;
    }
  }
  /// It does not depend on the order of the vertices, which elements may number differently.
  std::size_t hash(Index begin, Index end) const {
    std::uint64_t sum = 0;
    for (Index i = begin; i < end; ++i) {
      const std::uint64_t mixed =
          (out_.vertices[i] ^ std::bit_cast<std::uint64_t>(out_.weights[i])) * 0x9E3779B97F4A7C15u;
      sum += mixed ^ mixed >> 32;
    }
    return sum ^ sum >> 16;
  }
  bool are_equal(Index point, Index begin, Index end) const {
    const Index first = out_.first[point], last = out_.first[point + 1];
    const auto has = [&](Index i) {
      for (Index k = first; k < last; ++k)
        if (out_.vertices[k] == out_.vertices[i]) return out_.weights[k] == out_.weights[i];
      return false;
    };
    if (last - first != end - begin) return false;
    for (Index i = begin; i < end; ++i)
      if (!has(i)) return false;
    return true;
  }
  void grow() {
    const std::vector<Index> old =
        std::exchange(table_, std::vector<Index>(4 * table_.size(), none));
    for (const Index point : old) {
      if (point == none) continue;
      std::size_t i = hash(out_.first[point], out_.first[point + 1]);
      while (table_[i & (table_.size() - 1)] != none) ++i;
      table_[i & (table_.size() - 1)] = point;
    }
  }

  const CellComplex& complex_;
  EmbeddedPoints& out_;
  std::vector<Index> number_of_;  ///< of points in the places of vertices
  std::vector<Index> table_;      ///< of points on edges and faces, by their hashes
  std::size_t in_table_ = 0;      ///< of these points
};

/// Collects the cells of an embedding.
class EmbeddingBuilder {
 public:
  EmbeddingBuilder(const Parts& parts, const CellComplex& complex, Embedding& out)
      : parts_(parts),
        complex_(complex),
        out_(out),
        welding_(complex, parts.points.size(), out.points),
        added_(parts.points.size(), none) {}

  void build() {
    out_.tetrahedra.reserve(parts_.tetrahedra.size());
    out_.tetrahedron_element.reserve(parts_.tetrahedra.size());
    for (std::size_t t = 0; t < parts_.triangles.size(); ++t) add_triangle(t);
    std::size_t next = 0;
    for (Index e = 0; e < complex_.element_count(); ++e) {
      const bool is_partial = next < parts_.elements.size() && parts_.elements[next] == e;
      if (complex_.exists(3, e)) is_partial ? add_part(next) : add_open_faces(e);
      next += is_partial ? 1 : 0;
    }
  }

 private:
  Index point(Index p) {
    const Index known = added_[p];
    return known != none ? known : added_[p] = welding_.add(parts_.points[p]);
  }
  void add_triangle(Index element, const std::array<Index, 3>& corners, bool is_laid_open,
                    std::size_t source) {
    out_.triangles.push_back(corners);
    out_.triangle_element.push_back(element);
    out_.is_laid_open.push_back(is_laid_open ? 1 : 0);
    out_.triangle_source.push_back(static_cast<Index>(source));
  }
  /// On a side of an element.
  void add_triangle(Index element, const std::array<Index, 3>& corners, CubeSide side) {
    add_triangle(
        element, corners, is_laid_open(element, side),
        parts_.triangles.size() + 6 * std::size_t{element} + static_cast<std::size_t>(side.face()));
  }

  /// Adds a triangle of the parts. Those on an open side of their element come with the others
  /// there.
  void add_triangle(std::size_t t) {
    const auto& [a, b, c] = parts_.triangles[t];
    const Index element = parts_.points[a].element;
    if (!complex_.exists(3, element)) return;
    const unsigned open = open_sides(element);
    if (open != 0 && (sides(a) & sides(b) & sides(c) & open) != 0) return;
    add_triangle(element, {point(a), point(b), point(c)},
                 !parts_.is_cut.empty() && parts_.is_cut[t] != 0, t);
  }
  unsigned sides(Index p) const { return sides_at(parts_.points[p].at); }

  void add_part(std::size_t i) {
    const Index element = parts_.elements[i];
    const unsigned open = open_sides(element);
    for (Index t = parts_.first[i]; t < parts_.first[i + 1]; ++t) {
      const auto& c = parts_.tetrahedra[t];
      out_.tetrahedra.push_back({point(c[0]), point(c[1]), point(c[2]), point(c[3])});
      out_.tetrahedron_element.push_back(element);
      if (open != 0) add_open_faces(element, c, open);
    }
  }
  /// Those of a tetrahedron that lie on open sides of its element.
  void add_open_faces(Index element, const std::array<Index, 4>& corners, unsigned open) {
    const auto& [p, q, r, s] = corners;
    const std::array<unsigned, 4> at{sides(p), sides(q), sides(r), sides(s)};
    std::array<unsigned, 4> on;  // the open sides on which each face lies
    for (std::size_t f = 0; f < 4; ++f) {
      const auto& [a, b, c] = tetrahedron_faces[f];
      on[f] = at[a] & at[b] & at[c] & open;
    }
    if ((on[0] | on[1] | on[2] | on[3]) == 0) return;
    for (std::size_t i = 0; i < cube_sides.size(); ++i)
      for (std::size_t f = 0; f < 4; ++f)
        if (on[f] >> i & 1) {
          const auto& [a, b, c] = tetrahedron_faces[f];
          add_triangle(element, {point(corners[a]), point(corners[b]), point(corners[c])},
                       cube_sides[i]);
        }
  }
  /// Those of a full element.
  void add_open_faces(Index element) {
    const unsigned open = open_sides(element);
    if (open == 0) return;
    for (std::size_t i = 0; i < cube_sides.size(); ++i) {
      if ((open >> i & 1) == 0) continue;
      std::array<Index, 4> q = corners_of(cube_sides[i]);
      for (Index& corner : q) corner = welding_.add(complex_.vertices_of(element)[corner]);
      add_triangle(element, {q[0], q[1], q[2]}, cube_sides[i]);
      add_triangle(element, {q[0], q[2], q[3]}, cube_sides[i]);
    }
  }
  bool is_laid_open(Index element, CubeSide side) const {
    return parts_.outer_sides.empty() || (parts_.outer_sides[element] >> side.face() & 1) == 0;
  }
  /// Bit i for cube_sides[i].
  unsigned open_sides(Index element) const {
    unsigned open = 0;
    for (std::size_t i = 0; i < cube_sides.size(); ++i)
      if (complex_.neighbour(element, cube_sides[i].face()) == none) open |= 1u << i;
    return open;
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
  std::array<std::array<double, 2>, 3> factor;
  for (std::size_t a = 0; a < 3; ++a) factor[a] = {(1 - at[a]) / 2, (1 + at[a]) / 2};
  for (std::size_t n = 0; n < 8; ++n)
    weights[n] = factor[0][n & 1] * factor[1][n >> 1 & 1] * factor[2][n >> 2];
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
