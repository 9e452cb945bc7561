// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/contact/boundary_surface.hpp"
#include "kernel/contact/surface_points.hpp"

namespace suture {

/// What of a body may touch something: the vertices of its boundary, or the points of an embedded
/// surface. Both are combinations of vertices (ContactPoint).
class TouchingPoints {
 public:
  /// `embedding`: of a body with partial elements.
  TouchingPoints(const CellComplex& complex, Attributes& attributes,
                 SurfacePoints::Source embedding);

  const BoundarySurface& surface() const { return surface_; }
  bool are_embedded() const { return embedded_.has_value(); }
  SurfacePoints& embedded() { return *embedded_; }
  const SurfacePoints& embedded() const { return *embedded_; }

  /// Numbers are below.
  Index count() const { return embedded_ ? embedded_->size() : attributes_.vertex_count(); }
  ContactPoint operator[](Index number) const {
    return embedded_ ? (*embedded_)[number] : of_vertex(numbers_[number]);
  }
  /// visit(ContactPoint) for all.
  template <class Visit>
  void for_each(Visit visit) const;
  /// In the order of for_each().
  std::span<const Index> numbers() const {
    return embedded_ ? embedded_->numbers() : surface_.vertices();
  }
  /// On which they depend.
  std::span<const Index> ascending_vertices();
  /// Some that are near each other, and the vertices on which they depend.
  struct Cluster {
    std::span<const Index> numbers, vertices;
  };
  /// All are in one of them. `cell`: the width of those of an embedded surface,
  /// m.
  void find_clusters(double cell);
  std::size_t cluster_count() const { return cluster_ends_.size() - 1; }
  Cluster cluster(std::size_t i) const;

  /// Makes positions() and velocities() those of the vertices now.
  void gather() {
    if (embedded_) embedded_->gather(attributes_);
  }
  void gather(std::span<const Index> some) {
    if (embedded_) embedded_->gather(attributes_, some);
  }
  /// Rows of 4, by number.
  const double* positions() const {
    return embedded_ ? embedded_->positions() : attributes_.position().rows();
  }
  const double* velocities() const {
    return embedded_ ? embedded_->velocities() : attributes_.velocity().rows();
  }
  /// Where a point is now, m.
  Vec3 place(Index number) const { return (*this)[number].sum(attributes_.position().rows()); }

  void follow(const CellComplex& complex, const TopologyChange& change);
  void state(Archive& archive);

 private:
  static ContactPoint of_vertex(const Index& v) {
    static constexpr double one = 1;
    return {v, {&v, 1}, {&one, 1}};
  }
  void number_vertices();
  void add_cluster(std::span<const Index> numbers, std::span<const Index> vertices);

  Attributes& attributes_;
  BoundarySurface surface_;
  std::optional<SurfacePoints> embedded_;
  std::vector<Index> numbers_;   ///< 0, 1, 2 ... of vertices
  std::vector<Index> vertices_;  ///< on which they depend, ascending; empty: not known
  std::vector<Index> cluster_numbers_, cluster_vertices_;
  /// In these; empty: not known.
  std::vector<std::array<std::size_t, 2>> cluster_ends_;
};

template <class Visit>
void TouchingPoints::for_each(Visit visit) const {
  if (embedded_) {
    for (Index p = 0; p < embedded_->size(); ++p) visit((*embedded_)[p]);
  } else {
    for (const Index& v : surface_.vertices()) visit(of_vertex(v));
  }
}

}  // namespace suture
