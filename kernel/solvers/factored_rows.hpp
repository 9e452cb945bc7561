// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/solvers/block_rows.hpp"
#include "kernel/solvers/sparse_factor.hpp"

namespace suture {

/// The Cholesky factor of a matrix of block rows.
class FactoredRows {
 public:
  /// Chooses an elimination order; returns the floating-point operations of a factor.
  double analyse(const BlockPattern& pattern);

  /// Factors `a` on the components that are not held. If it is not positive definite, its diagonal
  /// is raised until it is: shift(). `soft`: nodes whose diagonal is raised by a thousandth,
  /// because nothing holds them. Throws NumericalError if a value is not finite.
  void factor(const BlockRows<double>& a, const Held& held, const std::vector<bool>& soft);
  /// x = A^-1 x; components that are held must be 0.
  void solve(std::span<double> x) const { factor_->solve(x); }

  double shift() const { return shift_; }  ///< relative to the diagonal; 0: positive definite
  std::size_t bytes() const { return factor_->bytes(); }

 private:
  LowerTriangle view() const { return {begin_, row_, value_}; }
  void fill(const BlockRows<double>& a, const Held& held, const std::vector<bool>& soft);
  void raise_diagonal(double part);

  std::unique_ptr<SparseFactor> factor_;
  std::vector<std::int32_t> begin_, row_;
  std::vector<double> value_;
  double shift_ = 0;
};

}  // namespace suture
