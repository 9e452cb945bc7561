// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "kernel/solvers/diagonal_blocks.hpp"

namespace suture {

/// Single-precision vectors of a level: 3 numbers per node, and one of padding, because products
/// load 4.
using SingleVector = std::vector<float>;
inline SingleVector single_vector(std::size_t nodes) { return SingleVector(nodes * 3 + 1); }

/// y = A x.
using SingleProduct = std::function<void(const float* x, float* y)>;

/// Smooths on one level by polynomials of D^-1 A, with the diagonal blocks D: optimised Chebyshev
/// polynomials of the fourth kind, which need no lower bound of the spectrum (Lottes, Numer. Linear
/// Algebra Appl. 30 (2023) e2518; arXiv:2202.08830). Symmetric in the inner product of A.
class Chebyshev {
 public:
  /// `inverse`: of the blocks D; 0 for components that are held. Estimates the largest eigenvalue
  /// of D^-1 A, by 10 products.
  void set(const DiagonalBlocks& inverse, const SingleProduct& multiply);
  float largest() const { return largest_; }

  /// x += p(D^-1 A) D^-1 r, and r -= A times that, except for the last term if `!finish`: then r is
  /// no longer the residual. `steps` products, or one less.
  void smooth(const SingleProduct& multiply, unsigned steps, SingleVector& x, SingleVector& r,
              bool finish) const;
  /// x += correction, r -= A correction.
  void correct(const SingleProduct& multiply, const SingleVector& correction, SingleVector& x,
               SingleVector& r) const;

  std::size_t bytes() const { return (inverse_.size() + 3 * d_.size()) * sizeof(float); }

 private:
  double estimate(const SingleProduct& multiply) const;
  void precondition(const SingleVector& r, SingleVector& z) const;
  /// d = keep d + add D^-1 r.
  void advance(float keep, float add, const SingleVector& r) const;

  std::vector<float> inverse_;      ///< column by column, 9 per node
  mutable SingleVector d_, q_, s_;  ///< scratch
  float largest_ = 0;
};

}  // namespace suture
