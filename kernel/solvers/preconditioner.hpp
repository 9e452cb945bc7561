// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <string>

#include "kernel/solvers/tangent_matrix.hpp"

namespace suture {

struct MultigridLevel;
class FactoredRows;

/// The levels of a multigrid and the factor of the coarsest one, lent to others: the next build()
/// computes their operators again.
struct CoarseLevels {
  std::deque<MultigridLevel>* levels = nullptr;
  FactoredRows* coarsest = nullptr;  ///< analysed
};

/// An approximate inverse of a tangent matrix: symmetric and positive definite. It belongs to the
/// cells and the free components of its first build(): where these change, make another one.
class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  /// Its name for users: "multigrid", "block Jacobi", "direct".
  virtual std::string name() const = 0;
  /// Builds the approximate inverse of `a` as it is now. Throws the errors of terms.
  virtual void build(const TangentMatrix& a) = 0;
  /// The coarse levels that build() uses for these cells and free components; none if it uses none.
  virtual CoarseLevels coarse_levels(const TangentMatrix& /*a*/) { return {}; }
  /// By what part of itself the diagonal was raised in build() to make the matrix positive
  /// definite; 0: it is.
  virtual double shift() const { return 0; }
  /// The levels of a multigrid, 0 of others and before build(). Of all that build() keeps for the
  /// next call, only this depends on the matrix.
  virtual std::size_t levels() const { return 0; }
  /// z = B^-1 r.
  virtual void apply(const double* r, double* z) const = 0;
  /// Memory that it holds after build().
  virtual std::size_t bytes() const = 0;
};

}  // namespace suture
