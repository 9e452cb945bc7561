// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/base/rows.hpp"
#include "kernel/parts/embedding.hpp"

namespace suture {

/// The bits of a vertex all of whose components are held.
inline constexpr int all_held = 7;

/// What an obstacle pushes: a vertex of the boundary, or a point of an embedded surface, which is a
/// combination of vertices.
struct ContactPoint {
  Index number;  ///< of the vertex, or of the point
  std::span<const Index> vertices;
  std::span<const double> weights;

  Vec3 sum(const double* rows) const {
    Vec3 sum = scaled(weights[0], row(rows, vertices[0]));
    for (std::size_t i = 1; i < vertices.size(); ++i)
      sum = plus(sum, scaled(weights[i], row(rows, vertices[i])));
    return sum;
  }
  /// Springs or masses in series: 1 / k = sum w^2 / k_v over the vertices that move; 0 without any.
  /// `held`: bits of the components of each vertex.
  double in_series(const double* values, const double* held) const;
  bool is_held(const double* held) const;
};

/// The points of an embedded surface, in the order of the embedding.
class SurfacePoints {
 public:
  /// The embedding as it is now, made again after operations.
  using Source = std::function<const Embedding&()>;
  explicit SurfacePoints(Source source) : source_(std::move(source)) {}

  /// Call after an operation: the points are others.
  void follow() { is_current_ = false; }

  Index size() const { return static_cast<Index>(points().size()); }
  ContactPoint operator[](Index p) const {
    const std::size_t first = points_.first[p], count = points_.first[p + 1] - first;
    return {p, std::span(points_.vertices).subspan(first, count),
            std::span(points_.weights).subspan(first, count)};
  }
  /// The vertices on which points depend, ascending.
  std::vector<Index> ascending_vertices() const;
  /// Corners by point, counterclockwise as seen from outside.
  std::span<const std::array<Index, 3>> triangles() const { return triangles_; }
  Index triangle_element(std::size_t t) const { return triangle_element_[t]; }
  /// Whether a cut or a removal has laid a triangle open.
  bool is_laid_open(std::size_t t) const { return is_laid_open_[t] != 0; }
  /// Whether it is a corner of such a triangle.
  bool is_lip(Index p) const { return is_lip_[p] != 0; }
  bool has_lips() const { return std::ranges::find(is_lip_, 1) != is_lip_.end(); }
  /// 0, 1, 2 ...
  std::span<const Index> numbers() const {
    points();
    return numbers_;
  }
  /// Makes positions() and velocities() those of the vertices now: rows of 4.
  void gather(Attributes& attributes) { gather(attributes, numbers()); }
  /// Those of some points only.
  void gather(Attributes& attributes, std::span<const Index> some);
  void gather_velocities(Attributes& attributes);
  const double* positions() const { return positions_.data(); }
  const double* velocities() const { return velocities_.data(); }

 private:
  const EmbeddedPoints& points() const;

  Source source_;
  mutable bool is_current_ = false;
  mutable EmbeddedPoints points_;  ///< of the corners of triangles
  mutable std::vector<std::array<Index, 3>> triangles_;
  mutable std::vector<Index> triangle_element_;
  mutable std::vector<std::uint8_t> is_laid_open_, is_lip_;
  mutable std::vector<Index> numbers_;
  std::vector<double> positions_, velocities_;
};

/// How impulses move a point: dv_i = w_i J / m_i for each of its vertices, and dv = J / m for the
/// point, 1 / m = sum w_i^2 / m_i over those that are free in a component.
class PointMass {
 public:
  /// `moving`: vertices; others are held. Null: all.
  PointMass(const ContactPoint& point, Attributes& attributes, const LiveMask* moving = nullptr);
  const ContactPoint& point() const { return point_; }
  /// Bits of components in which no vertex is free.
  unsigned fixed() const { return fixed_; }
  /// By component; of a point that is fixed there, as if it were free, kg.
  const Vec3& mass() const { return mass_; }
  /// That gives the point a change of its velocity, N s.
  Vec3 impulse(const Vec3& change) const {
    return {mass_[0] * change[0], mass_[1] * change[1], mass_[2] * change[2]};
  }
  /// Changes the velocity of the point by that of its vertices, and their positions accordingly.
  void change(const Vec3& velocity, double dt) const;

 private:
  /// Bits.
  unsigned held_components(Index vertex) const {
    if (moving_ && !(*moving_)[vertex]) return all_held;
    return static_cast<unsigned>(attributes_->fixed().rows()[vertex]);
  }

  ContactPoint point_;
  Attributes* attributes_;
  const LiveMask* moving_;
  Vec3 mass_{};
  unsigned fixed_ = 0;
  bool is_held_somewhere_ = false;  ///< a vertex in a component
};

}  // namespace suture
