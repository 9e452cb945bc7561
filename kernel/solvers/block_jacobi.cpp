// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/block_jacobi.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

namespace suture {
namespace {

using Block = Eigen::Matrix3d;

class BlockJacobi final : public Preconditioner {
 public:
  std::string name() const override { return "block Jacobi"; }

  void build(const TangentMatrix& a) override {
    sum(a);
    for (std::size_t v = 0; v < inverse_.size(); ++v) invert(inverse_[v], &a.free()[v * 3]);
  }

  void apply(const double* r, double* z) const override {
    using Vector = Eigen::Map<const Eigen::Vector3d>;
    for (std::size_t v = 0; v < inverse_.size(); ++v)
      Eigen::Map<Eigen::Vector3d>(z + v * 3) = inverse_[v] * Vector(r + v * 3);
  }

 private:
  void sum(const TangentMatrix& a) {
    inverse_.resize(a.size() / 3);
    for (Index v = 0; v < inverse_.size(); ++v) inverse_[v] = a.mass_at(v) * Block::Identity();
    a.for_each_cell([&](const CellTangents& cells) {
      const Index size = cells.nodes * 3;
      for (Index l = 0; l < cells.cells; ++l)
        for (Index n = 0; n < cells.nodes; ++n) {
          Block& block = inverse_[cells.vertices[l * cells.nodes + n]];
          for (Index i = 0; i < 3; ++i)
            for (Index j = 0; j < 3; ++j)
              block(i, j) -= cells.values[((n * 3 + i) * size + n * 3 + j) * 8 + l];
        }
    });
  }

  /// The inverse on the free components; where the block is not positive definite, that of its
  /// diagonal.
  static void invert(Block& block, const std::uint8_t* free) {
    block = (0.5 * (block + block.transpose())).eval();
    for (Eigen::Index i = 0; i < 3; ++i) {
      if (free[i]) continue;
      block.row(i).setZero();
      block.col(i).setZero();
      block(i, i) = 1;
    }
    const Eigen::Vector3d diagonal = block.diagonal().cwiseAbs().cwiseMax(1e-300);
    const Eigen::LLT<Block> factor(block);
    if (factor.info() == Eigen::Success)
      block = factor.solve(Block::Identity()).eval();
    else
      block = diagonal.cwiseInverse().asDiagonal();
    for (Eigen::Index i = 0; i < 3; ++i)
      if (!free[i]) block(i, i) = 0;
  }

  std::vector<Block> inverse_;
};

}  // namespace

std::unique_ptr<Preconditioner> make_block_jacobi() { return std::make_unique<BlockJacobi>(); }

}  // namespace suture
