// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/block_jacobi.hpp"

#include "kernel/solvers/diagonal_blocks.hpp"

namespace suture {
namespace {

class BlockJacobi final : public Preconditioner {
 public:
  std::string name() const override { return "block Jacobi"; }

  std::size_t bytes() const override { return inverse_.size() * sizeof(inverse_[0]); }

  void build(const TangentMatrix& a) override {
    inverse_ = mass_blocks(a);
    a.for_each_cell([&](const CellTangents& cells) { subtract(cells, inverse_); });
    for (std::size_t v = 0; v < inverse_.size(); ++v) {
      const std::uint8_t* free = &a.free()[v * 3];
      invert(inverse_[v], {free[0] != 0, free[1] != 0, free[2] != 0});
    }
  }

  void apply(const double* r, double* z) const override {
    using Vector = Eigen::Map<const Eigen::Vector3d>;
    for (std::size_t v = 0; v < inverse_.size(); ++v)
      Eigen::Map<Eigen::Vector3d>(z + v * 3) = inverse_[v] * Vector(r + v * 3);
  }

 private:
  DiagonalBlocks inverse_;
};

}  // namespace

std::unique_ptr<Preconditioner> make_block_jacobi() { return std::make_unique<BlockJacobi>(); }

}  // namespace suture
