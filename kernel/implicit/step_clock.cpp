// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/implicit/step_clock.hpp"

#include <algorithm>
#include <limits>

namespace suture {
namespace {

// Parts of the budget: what the first step keeps for its end, and every step for delays.
constexpr double first_rest = 0.3, reserve = 0.05;
// A part of the budget: what a preconditioner that is built in a step may take.
constexpr double largest_build = 0.5;
// By which the longest times fade from step to step.
constexpr double fading = 0.99;

}  // namespace

double StepClock::elapsed() const {
  return std::chrono::duration<double>(Wall::now() - start_).count();
}

IterationLimit StepClock::limit() {
  const unsigned most =
      budget_.iterations > 0 ? budget_.iterations : std::numeric_limits<unsigned>::max();
  last_ = 0;
  if (budget_.seconds == 0) return most;
  return {most, [this] { return is_over(); }};
}

/// Whether one more iteration would be too long.
bool StepClock::is_over() {
  const double now = elapsed();
  const bool is_first = last_ == 0;  // which is always made
  if (!is_first) iteration_ = std::max(iteration_, now - last_);
  last_ = now;
  const double rest = rest_ > 0 ? rest_ : first_rest * budget_.seconds;
  return !is_first && now + iteration_ + rest > (1 - reserve) * budget_.seconds;
}

void StepClock::end() {
  if (budget_.seconds == 0) return;
  rest_ = std::max(fading * rest_, elapsed() - solved_);
  iteration_ *= fading;
}

bool StepClock::allows_build(double seconds) const {
  return budget_.seconds == 0 || seconds < largest_build * budget_.seconds;
}

}  // namespace suture
