// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/solvers/coarsening.hpp"
#include "kernel/solvers/tangent_matrix.hpp"

namespace suture {

/// Some cells of a body that stand for all of them in the operator of a coarse level, as the points
/// of a quadrature do. A cell belongs to the coarse node with the largest share of its vertices,
/// and to the octant around that node in which its middle is. In each octant, the sample has the
/// hexahedron next to a point of Gauss' rule (two points along each axis of a coarse cell), or
/// several smaller cells: together as many nodes, at scattered places. The weight of a cell is the
/// number of those that it stands for.
///
/// The sample follows cuts as the coarse nodes do, and depends on the cells alone.
class CellSample {
 public:
  /// `p`: from the coarse level to the vertices; `places`: of the coarse nodes, in multiples of
  /// their spacing. O(cells); computes no tangents.
  CellSample(const TangentMatrix& a, const Interpolation& p, std::span<const Vec3> places);

  /// Visits the matrices of the sample, with the weight of each cell: see
  /// TangentMatrix::for_each_cell.
  using Visit = std::function<void(const CellTangents&, std::span<const float> weights)>;
  void for_each_cell(const TangentMatrix& a, const Visit& visit) const;

  std::size_t size() const { return weights_.size(); }

 private:
  struct Places;
  void choose(const Places& cells, std::size_t functor);

  std::vector<bool> is_chosen_;  ///< per cell, in the order of for_some_cells()
  std::vector<float> weights_;   ///< of the chosen ones
};

}  // namespace suture
