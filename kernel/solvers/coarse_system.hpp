// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "kernel/solvers/cell_sample.hpp"
#include "kernel/solvers/conjugate_gradients.hpp"
#include "kernel/solvers/multigrid_levels.hpp"
#include "kernel/solvers/preconditioner.hpp"

namespace suture {

/// The linear systems of Newton's method for displacements that a coarse level can represent:
///   P^T A P q = P^T r,   d = P q
/// with the interpolation P from that level to the vertices. Solved by conjugate gradients, whose
/// products use the matrix of the body itself. Their preconditioner, the V-cycle from that level,
/// is built from a sample of the cells, which costs a fraction of the operators of a multigrid.
///
/// Overwrites the operators of the levels.
class CoarseSystem {
 public:
  /// Level 1 is the finest one that is possible. O(cells).
  CoarseSystem(const CoarseLevels& coarse, std::size_t level, const TangentMatrix& a);

  /// Builds the preconditioner for `a` as it is now. Throws the errors of terms.
  void build(const TangentMatrix& a);
  /// P^T r.
  std::vector<double> restrict(std::span<const double> r) const;
  /// Solves for the right-hand side P^T r to a tenth of it; if that fails, d is a descent direction
  /// nevertheless. Throws the errors of terms.
  LinearSolve::Outcome solve(const TangentMatrix& a, std::span<const double> right,
                             std::span<double> d) const;

  std::size_t nodes() const { return levels_[level_].nodes(); }

 private:
  void prolong(const float* q) const;
  void restrict_image(float* result) const;

  MultigridLevels& levels_;
  FactoredRows& coarsest_;
  std::size_t level_;
  Interpolation p_;
  CellSample sample_;
  mutable std::vector<SingleVector> scratch_;  ///< P q on the finer levels
  mutable SingleVector image_;                 ///< A P q
};

}  // namespace suture
