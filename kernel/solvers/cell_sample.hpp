// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/solvers/coarsening.hpp"
#include "kernel/solvers/tangent_matrix.hpp"

namespace suture {

/// Some cells of a body that stand for all of them in the operator of a coarse level, as the points
/// of a quadrature do. A cell belongs to the coarse node with the largest share of its vertices;
/// of those of a functor, every coarse node has a few in the sample, scattered over its support.
/// Their weights add up to the number of cells that belong to the node.
///
/// The sample follows cuts as the coarse nodes do, and depends on the cells alone.
class CellSample {
 public:
  /// `p`: from the coarse level to the vertices. `nodes_of_cells`: how many nodes the cells of one
  /// functor have together that belong to one coarse node. O(cells); computes no tangents.
  CellSample(const TangentMatrix& a, const Interpolation& p, Index nodes_of_cells);

  /// Visits the matrices of the sample, with the weight of each cell: see
  /// TangentMatrix::for_each_cell.
  using Visit = std::function<void(const CellTangents&, std::span<const float> weights)>;
  void for_each_cell(const TangentMatrix& a, const Visit& visit) const;

  std::size_t size() const { return weights_.size(); }

 private:
  struct Owners;
  void choose(const Owners& owners, std::size_t functor, Index nodes_of_cells);

  std::vector<bool> is_chosen_;  ///< per cell, in the order of for_some_cells()
  std::vector<float> weights_;   ///< of the chosen ones
};

}  // namespace suture
