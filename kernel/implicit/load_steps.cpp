// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/implicit/load_steps.hpp"

#include <algorithm>

namespace suture {
namespace {

// With so few iterations, the second of two good load steps may be followed by a larger one.
constexpr unsigned few_iterations = 8;
// rad. Positions do not tell a turn by 360 degrees from none: a rotation is followed.
constexpr double largest_turn = 3.14159265358979323846 / 4;

}  // namespace

void LoadSteps::solve(const StepEquations& equations) {
  path_.begin(equations);
  if (path_.turn(0, 1) > largest_turn) {
    if (const auto& note = path_.newton().on_note)
      note("a rotation by more than 45 degrees is followed in parts");
    walk();
  } else if (!path_.try_at(1) && !(path_.drop_prediction() && path_.try_at(1))) {
    report(1, 0, 0.5);
    walk();
  }
}

void LoadSteps::walk() {
  path_.hold_back();
  double found = 0, step = 0.5;
  bool was_found = false;
  while (found < 1) {
    while (path_.turn(found, std::min(found + step, 1.0)) > largest_turn && step > least_step)
      step /= 2;
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
