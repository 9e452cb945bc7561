// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/diagonal_blocks.hpp"

#include <Eigen/Cholesky>

namespace suture {

using Eigen::Matrix3d;

DiagonalBlocks mass_blocks(const TangentMatrix& a) {
  DiagonalBlocks blocks(a.size() / 3);
  for (Index v = 0; v < blocks.size(); ++v) blocks[v] = a.mass_at(v) * Matrix3d::Identity();
  return blocks;
}

void subtract(const CellTangents& cells, DiagonalBlocks& blocks) {
  for_each_diagonal_block(cells, [&](Index v, const Matrix3d& block) { blocks[v] -= block; });
}

void invert(Matrix3d& block, const std::array<bool, 3>& free, double shift) {
  block = (0.5 * (block + block.transpose())).eval();
  block.diagonal().array() += shift * block.trace();
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (free[static_cast<std::size_t>(i)]) continue;
    block.row(i).setZero();
    block.col(i).setZero();
    block(i, i) = 1;
  }
  const Eigen::Vector3d diagonal = block.diagonal().cwiseAbs().cwiseMax(1e-300);
  const Eigen::LLT<Matrix3d> factor(block);
  if (factor.info() == Eigen::Success)
    block = factor.solve(Matrix3d::Identity()).eval();
  else
    block = diagonal.cwiseInverse().asDiagonal();
  for (Eigen::Index i = 0; i < 3; ++i)
    if (!free[static_cast<std::size_t>(i)]) block(i, i) = 0;
}

}  // namespace suture
