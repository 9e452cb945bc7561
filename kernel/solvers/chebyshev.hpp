// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/solvers/diagonal_blocks.hpp"
#include "kernel/solvers/single_vector.hpp"

namespace suture {

/// Smooths on one level by polynomials of D^-1 A, with the diagonal blocks D: optimised Chebyshev
/// polynomials of the fourth kind, which need no lower bound of the spectrum (Lottes, Numer. Linear
/// Algebra Appl. 30 (2023) e2518; arXiv:2202.08830). Symmetric in the inner product of A.
///
/// Components that are held are 0 in all results, whatever products have there.
class Chebyshev {
 public:
  /// `inverse`: of the blocks D; 0 for components that are held. Estimates the largest eigenvalue
  /// of D^-1 A, by 10 products. `workers` share loops from now on.
  void set(const DiagonalBlocks& inverse, const SingleProduct& multiply, const Workers* workers);
  float largest() const { return largest_; }

  /// x = p(D^-1 A) D^-1 r, r -= A x. `steps` products.
  void smooth(const SingleProduct& multiply, unsigned steps, SingleVector& x,
              SingleVector& r) const;
  /// x += correction, r -= A correction, and then x += p(D^-1 A) D^-1 r. Destroys r. `steps`
  /// products.
  void correct(const SingleProduct& multiply, unsigned steps, const SingleVector& correction,
               SingleVector& x, SingleVector& r) const;

  std::size_t bytes() const { return (inverse_.size() + 3 * d_.size()) * sizeof(float); }

 private:
  double estimate(const SingleProduct& multiply) const;
  void add(float factor, const SingleVector& from, SingleVector& to) const;

  AlignedVector<float> inverse_;    ///< xx, yy, zz, xy, yz, xz per node
  mutable SingleVector d_, q_, s_;  ///< scratch
  float largest_ = 0;
  const Workers* workers_ = nullptr;
};

}  // namespace suture
