// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/load_steps.hpp"

#include <algorithm>

namespace suture {
namespace {

// With so few iterations, the second of two good load steps may be followed by a larger one.
constexpr unsigned few_iterations = 8;

}  // namespace

void LoadSteps::solve(const StepEquations& equations) {
  path_.begin(equations);
  if (!path_.try_at(1)) walk();
}

/// The path in parts; the first equations that failed were those at its end.
void LoadSteps::walk() {
  report(1, 0, 0.5);
  path_.hold_back();
  double found = 0, step = 0.5;
  bool was_found = false;
  while (found < 1) {
    const double part = std::min(found + step, 1.0);
    if (path_.try_at(part)) {
      found = part;
      if (was_found && path_.newton().iterations() <= few_iterations) step *= 2;
      was_found = true;
      report(part, found, step);
    } else {
      step /= 2;
      was_found = false;
      report(part, found, step);
      if (step < least_step)
        path_.refuse("load steps",
                     "end at " + percent(found) + " of the change of loads and motions");
    }
  }
}

void LoadSteps::report(double part, double found, double step) const {
  const auto& note = path_.newton().on_note;
  if (!note) return;
  if (part == found)
    note("equilibrium at " + percent(part) + " of the change in this step");
  else
    note("no equilibrium at " + percent(part) + " of the change in this step (" +
         path_.failure().reason + "); continuing from " + percent(found) + " with " +
         percent(step));
}

}  // namespace suture
