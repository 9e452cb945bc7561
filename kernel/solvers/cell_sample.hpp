// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/solvers/coarsening.hpp"
#include "kernel/solvers/tangent_matrix.hpp"

namespace suture {

/// Some cells of a body that stand for all of them in the operator of a coarse level. A cell
/// belongs to the coarse node with the largest share of its vertices, and to the octant around that
/// node in which its middle is. The sample takes an eighth of the hexahedra in an octant, at least
/// one and at most four, at scattered places. It takes more of smaller cells: they have eight nodes
/// in all. The weight of a cell is the number of those that it stands for. All cells around a
/// coarse node join the sample where those that were chosen hardly depend on it, as beside vertices
/// that are held.
///
/// The sample follows cuts as the coarse nodes do. It depends on the cells and on what is free.
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
  std::vector<bool> missed_nodes(const TangentMatrix& a, const Interpolation& p,
                                 const Places& cells) const;
  void choose(const Places& cells, const std::vector<bool>& own);
  void choose(const Places& cells, std::size_t functor, const std::vector<bool>& own);

  std::vector<bool> is_chosen_;  ///< per cell, in the order of for_some_cells()
  std::vector<float> weights_;   ///< of the chosen ones
};

}  // namespace suture
