// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kernel/solvers/tangent_matrix.hpp"

namespace suture {

/// The 3 x 3 blocks on the diagonal of a matrix, one per node.
using DiagonalBlocks = std::vector<Eigen::Matrix3d>;

/// The blocks of the mass term of a matrix.
DiagonalBlocks mass_blocks(const TangentMatrix& a);
/// Calls visit(vertex, block) for the blocks of cells.
template <class Visit>
void for_each_diagonal_block(const CellTangents& cells, Visit&& visit) {
  const Index size = cells.nodes * 3;
  for (Index l = 0; l < cells.cells; ++l)
    for (Index n = 0; n < cells.nodes; ++n) {
      Eigen::Matrix3d block;
      for (Index i = 0; i < 3; ++i)
        for (Index j = 0; j < 3; ++j)
          block(i, j) = cells.values[((n * 3 + j) * size + n * 3 + i) * 8 + l];
      visit(cells.vertices[l * cells.nodes + n], block);
    }
}
/// Subtracts the blocks of cells, which come with the opposite sign.
void subtract(const CellTangents& cells, DiagonalBlocks& blocks);

/// The inverse of a block, raised by `shift` of its trace, on the components that are free and 0 on
/// the others; where the block is not positive definite, that of the magnitudes of its diagonal.
void invert(Eigen::Matrix3d& block, const std::array<bool, 3>& free, double shift = 0);

}  // namespace suture
