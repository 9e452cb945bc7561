// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>

// CHOLMOD behind a small interface. Its libraries (BLAS, LAPACK, METIS, Fortran and OpenMP) are
// used only by the module libsuture-cholmod.so, which is loaded when the first factor is made.

namespace suture {

/// The lower triangle of a symmetric matrix, column by column; rows ascend from the diagonal.
struct LowerTriangle {
  std::span<const std::int32_t> begin;  ///< per column, and the end
  std::span<const std::int32_t> row;
  std::span<const double> value;
};

/// The Cholesky factor of a sparse matrix.
class SparseFactor {
 public:
  virtual ~SparseFactor() = default;
  /// Chooses an elimination order for a pattern; values are not read. Returns the number of
  /// floating-point operations of a factor. Throws std::bad_alloc.
  virtual double analyse(const LowerTriangle& a) = 0;
  /// Computes the factor of a matrix of that pattern. False if it is not positive definite. Throws
  /// std::bad_alloc.
  virtual bool factor(const LowerTriangle& a) = 0;
  /// x = A^-1 x, after a factor() that returned true. Reuses memory: one call at a time.
  virtual void solve(std::span<double> x) = 0;
  virtual std::size_t bytes() const = 0;  ///< of the factor
};

/// A factor of the module, which is loaded at the first call. Throws IoError if it cannot be
/// loaded.
std::unique_ptr<SparseFactor> make_sparse_factor();

}  // namespace suture
