// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "kernel/solvers/preconditioner.hpp"

namespace suture {

struct MultigridOptions {
  unsigned smoothing = 2;      ///< steps before and after each coarse correction
  Index coarsest_nodes = 200;  ///< a level with no more nodes is factored
};

/// A V-cycle on a hierarchy that follows the cuts (coarsening.hpp), with Galerkin operators,
/// polynomial smoothing (chebyshev.hpp) and a Cholesky factor on the coarsest level. The number of
/// iterations hardly depends on the size of the body. Products are in single precision, those of
/// the finest level matrix-free; operators and factor are computed in double.
///
/// Memory: see MultigridOptions. The complex, the attributes and the matrix of the last build() are
/// read in every apply().
std::unique_ptr<Preconditioner> make_multigrid(const CellComplex& complex, Attributes& attributes,
                                               const MultigridOptions& options = {});

}  // namespace suture
