// SPDX-License-Identifier: GPL-3.0-or-later
//
// Newton's method at a solution: what others ask about the equations there.
#include <algorithm>

#include "kernel/implicit/newton.hpp"

namespace suture {

Newton::Balance Newton::balance(const StepEquations& equations) {
  constexpr double allowed = 10;  // constrained vertices have moved to their exact positions
  start(equations);
  const double left = evaluate(equations);
  if (left <= allowed * tolerance_ * scale_) return {left, scale_, true};
  const double scale = scale_;
  return {left, scale, left <= allowed * noise(equations)};
}

bool Newton::holds_free_pieces() {
  if (!relief_) return false;
  relief_->find();
  return !relief_->supports().empty();
}

LinearSolve Newton::solve_tangent(const StepEquations& equations, std::span<const double> b,
                                  std::span<double> x, double tolerance, bool is_transposed) {
  solver_.begin_step();
  start(equations);
  solver_.set_matrix(equations);
  solver_.set_symmetric(is_symmetric(equations), is_transposed);
  std::vector<double> right(b.begin(), b.end());
  solver_.matrix().restrict(right);
  std::ranges::fill(x, 0.0);
  LinearSolve solve;
  if (std::ranges::any_of(right, [](double r) { return r != 0; }))
    solve = solver_.solve(right, x, tolerance);
  solver_.reject_step();
  return solve;
}

}  // namespace suture
