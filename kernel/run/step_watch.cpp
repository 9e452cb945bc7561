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
  stable_ = bound().value_or(0);
  if (*scene_.solver.dt > stable_) search(0);
}

void StepWatch::after_event(std::uint64_t step) {
  if (warned_) return;  // nothing more to say
  const std::optional<double> safe = bound();
  if (!scene_.solver.dt) {
    if (!safe) return search(step);
    stable_ = std::min(stable_, *safe);
    due_ = step + search_steps;
  } else if (!safe || *scene_.solver.dt > *safe) {
    due_ = std::max(step, searched_ + search_steps);
  }
}

void StepWatch::after_step(std::uint64_t step) {
  if (step >= due_) search(step);
}

/// None if a model gives no bounds.
std::optional<double> StepWatch::bound() {
  try {
    return world_.dynamics->bounds().dt;
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
