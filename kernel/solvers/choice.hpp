// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "kernel/solvers/multigrid.hpp"

namespace suture {

struct PreconditionerChoice {
  enum class Kind { open, block_jacobi, direct, multigrid };
  Kind kind = Kind::open;
  std::unique_ptr<Preconditioner> preconditioner;
  std::string reason;  ///< for `suture explain`: a clause that follows its name
};

/// The fastest preconditioner for a matrix: block Jacobi if the mass term dominates, the direct
/// solver for bodies of few elements, the multigrid otherwise. The choice holds as long as the
/// number of elements and the mass term do not change much. One product with the matrix.
PreconditionerChoice choose_preconditioner(const CellComplex& complex, Attributes& attributes,
                                           const TangentMatrix& a,
                                           const MultigridOptions& options = {});

}  // namespace suture
