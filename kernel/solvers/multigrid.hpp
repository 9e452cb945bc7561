// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "kernel/solvers/preconditioner.hpp"

// A multigrid that follows the cuts
// =================================
//
//   level 0   o o o o|o o o o      matrix-free, smoothed       \               / correct, smooth
//   level 1   o   o  |  o   o      Galerkin, from the cells     \             /
//   level 2   o      |      o      Galerkin                      \_ CHOLMOD _/
//                   cut: the nodes on its sides are different on every level
//
// - Operators are Galerkin products, P^T A P. Those of level 1 come from the cell matrices of all
//   models, so a model provides nothing.
// - The smoother is an optimised Chebyshev polynomial of the fourth kind, 2 + 2 steps, on 3 x 3
//   diagonal blocks. It needs products only. Those of the finest level are matrix-free, in single
//   precision. Operators and factors are computed in double: in single precision they became
//   indefinite.
// - CHOLMOD factors the coarsest level. If the matrix is not positive definite, its diagonal is
//   raised, and Preconditioner::shift() reports by how much. Pieces that nothing holds have rigid
//   motions without stiffness; the factor treats them as if they were held softly. Whether their
//   loads are in balance is the concern of the caller.
// - Coarsening ends at 200 nodes, or where slits are no longer resolved. The latter is measured by
//   solving with the cycle itself (stop_test.hpp), instead of derived from distances between cuts.
//   As that takes as long as a solution, steps measure it only where a hierarchy is slow, and the
//   hierarchies after a cut have as many levels as before. General hexahedra take 14 % less time
//   from rest and 20 % less after a cut; frames with cuts take up to 17 % less. The number of
//   levels is part of checkpoints. A resumed run thus makes the same hierarchy without the matrix
//   of the step that began it.
// - Building the hierarchy after an operation costs 0.5 us per element on grids, 3 elsewhere.
//
// Products with the tangent are two thirds of a solution. As cell matrices and for the largest
// eigenvalue, they are half of the set-up.

namespace suture {

struct MultigridOptions {
  unsigned smoothing = 2;      ///< steps before and after each coarse correction
  Index coarsest_nodes = 200;  ///< a level with no more nodes is factored
  /// As found by the first build() of an earlier multigrid of the same cells; 0: to be found.
  std::size_t levels = 0;
  /// Whether the first build() finds where coarsening ends (stop_test.hpp), which takes as long as
  /// a solution of the system; otherwise coarsening ends with `coarsest_nodes`.
  bool finds_end = true;
};

/// A V-cycle on a hierarchy that follows the cuts (coarsening.hpp), with Galerkin operators,
/// polynomial smoothing (chebyshev.hpp) and a Cholesky factor on the coarsest level. The number of
/// iterations hardly depends on the size of the body. Products are in single precision, those of
/// the finest level matrix-free; operators and factor are computed in double. A body that is too
/// small for levels is factored.
///
/// Memory: 430 B per element on grids, up to 1.3 kB elsewhere; twice that during build(). The
/// results depend on levels() and on the matrix of the last build(), which is read in every
/// apply().
std::unique_ptr<Preconditioner> make_multigrid(const CellComplex& complex, Attributes& attributes,
                                               const MultigridOptions& options = {});

}  // namespace suture
