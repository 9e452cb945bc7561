// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/solvers/conjugate_gradients.hpp"
#include "kernel/solvers/multigrid_levels.hpp"

namespace suture {

/// Solves A x = r until |r - A x| <= tolerance |r|, with A given by its products, by conjugate
/// gradients with the V-cycle from level l, in single precision. If `max_iterations` were not
/// enough, or if A turned out to be indefinite, x is a descent direction nevertheless
/// (conjugate_gradients.hpp).
LinearSolve::Outcome solve_on_level(MultigridLevels& levels, const VCycle& cycle, std::size_t l,
                                    const SingleProduct& multiply, SingleVector r, double tolerance,
                                    unsigned max_iterations, SingleVector& x);

}  // namespace suture
