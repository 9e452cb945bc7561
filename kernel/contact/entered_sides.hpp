// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/base/archive.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// The side from which each vertex touched an obstacle in the last step. Forces let a vertex sink
/// in, and through the middle of a thin obstacle: from its position alone, it would then belong to
/// the other side. What is kept is a place just outside on the right side, in the coordinates of
/// the obstacle; the next gap is that of a way from there (PlacedObstacle::gap_from).
class EnteredSides {
 public:
  /// Null if the vertex did not touch the obstacle.
  const Vec3* outside(std::size_t obstacle, Index vertex) const;
  void clear();
  void add(std::size_t obstacle, Index vertex, const Vec3& outside);

  /// Vertices that separate from one that touches keep its side.
  void follow(const CellComplex& complex, const TopologyChange& change);
  /// `obstacles`, `vertices`: how many there are.
  void state(Archive& archive, std::size_t obstacles, Index vertices);

 private:
  struct Side {
    Index obstacle, vertex;
    Vec3 outside;
  };
  void find_places();

  std::vector<Side> sides_;
  std::vector<std::vector<Index>> places_;  ///< in sides_, by obstacle and vertex, or none
};

}  // namespace suture
