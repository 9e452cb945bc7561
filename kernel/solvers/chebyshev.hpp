// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/solvers/block_rows.hpp"
#include "kernel/solvers/diagonal_blocks.hpp"

namespace suture {

/// Single-precision vectors of a level with 3 numbers per node, and one value of padding.
using SingleVector = std::vector<float>;
inline SingleVector single_vector(std::size_t nodes) { return SingleVector(nodes * 3 + 1); }

/// Smooths on one level by polynomials of D^-1 A, with the diagonal blocks D: Chebyshev of the
/// fourth kind (Lottes, Numer. Linear Algebra Appl. 30 (2023) e2518), which need no lower bound of
/// the spectrum. Symmetric in the inner product of A.
class Chebyshev {
 public:
  /// `inverse`: of the blocks D; 0 for components that are held.
  void set(const DiagonalBlocks& inverse);

  /// Estimates the largest eigenvalue of D^-1 A by power iteration: always from the same start.
  /// multiply(x, y): y = A x.
  template <class Multiply>
  void estimate(const Multiply& multiply, unsigned steps);
  float largest() const { return largest_; }

  /// x += p(D^-1 A) D^-1 r, and r -= A times that, except for the last term if `!finish`: then r is
  /// no longer the residual.
  template <class Multiply>
  void smooth(const Multiply& multiply, unsigned steps, SingleVector& x, SingleVector& r,
              bool finish) const;

  std::size_t bytes() const { return (inverse_.size() + d_.size() + q_.size()) * sizeof(float); }

 private:
  void start();
  double normalise();
  /// d = keep d + add D^-1 r, x += d.
  void advance(float keep, float add, const SingleVector& r, SingleVector& x) const;
  void subtract_product(SingleVector& r) const;

  std::vector<float> inverse_;  ///< column by column, 9 per node, padded
  mutable SingleVector d_, q_;  ///< scratch
  float largest_ = 0;
};

template <class Multiply>
void Chebyshev::estimate(const Multiply& multiply, unsigned steps) {
  constexpr double safety = 1.1;
  start();
  SingleVector zero(d_.size());
  double size = normalise();
  for (unsigned i = 0; i < steps && size > 0; ++i) {
    multiply(d_.data(), q_.data());
    advance(0, 1, q_, zero);
    size = normalise();
  }
  largest_ = static_cast<float>(safety * size);
}

template <class Multiply>
void Chebyshev::smooth(const Multiply& multiply, unsigned steps, SingleVector& x, SingleVector& r,
                       bool finish) const {
  if (!(largest_ > 0)) return;
  for (unsigned i = 0; i < steps; ++i) {
    const float odd = static_cast<float>(2 * i + 3);
    advance(i == 0 ? 0.0f : static_cast<float>(2 * i - 1) / odd,
            static_cast<float>(8 * i + 4) / (odd * largest_), r, x);
    if (i + 1 == steps && !finish) return;
    multiply(d_.data(), q_.data());
    subtract_product(r);
  }
}

}  // namespace suture
