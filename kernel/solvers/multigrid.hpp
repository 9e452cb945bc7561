// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "kernel/solvers/preconditioner.hpp"

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
/// Memory: 380 B per element on grids, up to 1.7 kB elsewhere; twice that during build(). The
/// results depend on levels() and on the matrix of the last build(), which is read in every
/// apply().
std::unique_ptr<Preconditioner> make_multigrid(const CellComplex& complex, Attributes& attributes,
                                               const MultigridOptions& options = {});

}  // namespace suture
