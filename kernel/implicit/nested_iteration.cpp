// SPDX-License-Identifier: GPL-3.0-or-later
//
// Newton's method for equilibria far from the current positions starts on coarse levels.
#include <algorithm>
#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/implicit/newton.hpp"
#include "kernel/solvers/coarse_system.hpp"

// Nested iteration
// ================
//
//   level 3   Newton ->.                         residual P^T r with the forces of the whole body
//   level 2             `-> Newton ->.
//   body                              `-> Newton to the tolerance
//
// The unknowns of a level are its displacements q; the vertices move by P q. Slits remain slits on
// every level. The systems P^T A P q = P^T r are solved to a tenth by conjugate gradients. Their
// products use the matrix-free tangent of the body in single precision. The preconditioner is the
// V-cycle from that level. Its operators come from a sample of the cells
// (solvers/cell_sample.hpp), an eighth of them on level 2, a 16th on level 3. Operators are
// computed in every second iteration, and after a system that was not solved.

namespace suture {
namespace {

// A part of the forces: closer to the equilibrium, Newton's method needs few iterations anyway.
constexpr double far_residual = 0.3;

// An iteration on level 1 costs as much as one of the body, and saves less than one.
constexpr std::size_t finest_level = 2;

// What is left of the residual of a level.
constexpr double reduction = 0.3;
constexpr unsigned max_iterations = 15;
// After two iterations it still is a good preconditioner.
constexpr unsigned iterations_per_build = 2;
// A shorter step means that the body is about to collapse.
constexpr double shortest_step = 1.0 / 64;

}  // namespace

/// Moves the vertices to an approximate solution among the displacements of coarse levels, from the
/// coarsest one on, and updates the residual. False, and nothing moves, where that is not
/// worthwhile or fails.
bool Newton::start_from_coarse_levels(const StepEquations& equations) {
  const bool is_part = !equations.loads.empty() || !equations.held_back.empty();  // of a path
  const bool touches = motion_.body().contact() != nullptr;  // not the points of coarse levels
  if (equations.acceleration != 0 || relief_ || is_part || touches) return false;
  if (!(norm(residual_) > far_residual * scale_)) return false;
  set_remaining(equations.time);
  if (is_moving_) return false;
  solver_.set_matrix(equations);
  const CoarseLevels coarse = solver_.coarse_levels();
  if (!coarse.levels) return false;
  bool has_moved = false;
  for (std::size_t l = coarse.levels->size() - 1; l >= finest_level; --l) {
    CoarseSystem system(coarse, l, solver_.matrix());
    const std::vector<double> start = start_;
    if (!solve_on_level(equations, system)) {
      std::ranges::copy(start, motion_.body().attributes().position().rows());
      evaluate(equations);
      break;
    }
    has_moved = true;
  }
  return has_moved;
}

/// Newton's method on one coarse level. False if it does not converge; the vertices are anywhere
/// then.
bool Newton::solve_on_level(const StepEquations& equations, CoarseSystem& system) {
  std::vector<double> right = system.restrict(residual_);
  const double first = norm(right);
  double residual = first;
  bool is_worn = false;  // the preconditioner
  for (unsigned i = 0; residual > reduction * first; ++i) {
    check_abandoned();
    if (i == max_iterations) return false;
    const bool builds = is_worn || i % iterations_per_build == 0;
    try {
      if (builds) system.build(solver_.matrix());
      is_worn = system.solve(solver_.matrix(), right, direction_) == LinearSolve::Outcome::too_many;
      if (is_worn && builds) return false;
    } catch (const NumericalError&) {
      return false;
    }
    const double step = search(equations);
    if (step < shortest_step) return false;
    set_remaining(equations.time);
    right = system.restrict(residual_);
    residual = norm(right);
    if (on_iteration) on_iteration({i + 1, 0, residual, first, step, false, system.nodes()});
  }
  return std::isfinite(residual);
}

}  // namespace suture
