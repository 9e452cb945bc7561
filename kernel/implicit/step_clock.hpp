// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>

#include "kernel/dynamics/step_budget.hpp"
#include "kernel/solvers/conjugate_gradients.hpp"

namespace suture {

/// When the linear solve of a step has to end, so that the step keeps its budget. What follows the
/// solve takes as long as it did in earlier steps, and an iteration as long as those before it.
class StepClock {
 public:
  explicit StepClock(const StepBudget& budget) : budget_(budget) {}

  /// A step begins.
  void begin() { start_ = Wall::now(); }
  /// Its linear solve begins; valid until it ends.
  IterationLimit limit();
  void end_solve() { solved_ = elapsed(); }
  /// The step ends.
  void end();

  /// Whether a preconditioner may be built in a step, which takes so many s.
  bool allows_build(double seconds) const;

 private:
  using Wall = std::chrono::steady_clock;
  double elapsed() const;
  bool is_over();

  StepBudget budget_;
  Wall::time_point start_{};
  double last_ = 0;    ///< when it was last asked whether it is over, s from the start; 0: not yet
  double solved_ = 0;  ///< when the solve ended, s from the start
  // The longest of the last steps, s:
  double iteration_ = 0;
  double rest_ = 0;  ///< what follows the solve; 0: not known yet
};

}  // namespace suture
