// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/step_watch.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "kernel/base/error.hpp"

namespace suture {

void StepWatch::start() {
  if (!scene_.solver.dt) {
    search(0);
    if (!std::isfinite(stable_))
      throw InputError(
          "/solver/dt: \"auto\" needs a force, and no model gives one; give a number of seconds");
    return;
  }
  stable_ = bound(&Dynamics::bounds).value_or(0);
  if (*scene_.solver.dt > stable_) search(0);
}

void StepWatch::after_event(std::uint64_t step) {
  if (warned_) return;  // nothing more to say
  const std::optional<double> local = bound(&Dynamics::bounds_of_changes);
  if (scene_.solver.dt) {
    if (!local || *scene_.solver.dt > *local) due_ = std::max(step, searched_ + search_steps);
  } else if (!local) {
    search(step);
  } else if (*local < stable_) {
    stable_ = *local;
    lowered_ = step;
  }
}

void StepWatch::after_step(std::uint64_t step) {
  if (step < due_) return;
  const bool quiet = step >= lowered_ + search_steps;
  if (scene_.solver.dt || quiet || step >= searched_ + most_steps) return search(step);
  stable_ = bound(&Dynamics::bounds).value();  // lowered_ by such a bound
  due_ = step + search_steps;
}

/// None if a model gives no bounds.
std::optional<double> StepWatch::bound(ForceLoop::Bounds (Dynamics::*which)()) {
  try {
    return (*world_.dynamics.*which)().dt;
  } catch (const PluginError&) {
    return std::nullopt;
  }
}

void StepWatch::search(std::uint64_t step) {
  searched_ = step;
  due_ = scene_.solver.dt ? never : step + search_steps;
  try {
    stable_ = world_.dynamics->stable_step();
  } catch (const PluginError&) {
    if (!scene_.solver.dt) throw;
    return;  // a model without a bound runs with the user's dt
  }
  compare();
}

void StepWatch::compare() {
  if (warned_ || !scene_.solver.dt || !(*scene_.solver.dt > stable_)) return;
  warned_ = true;
  due_ = never;
  std::ostringstream text;
  text << "/solver/dt is " << *scene_.solver.dt
       << " s, above the stable step of the present state, " << stable_
       << " s; the run will become unstable, \"auto\" follows it";
  diagnostics_.warn(text.str());
}

}  // namespace suture
