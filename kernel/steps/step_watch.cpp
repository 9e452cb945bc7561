// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/steps/step_watch.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/forces/contact_law.hpp"

namespace suture {
namespace {

/// Right motion reaches h w = 1.3, an unstable step drives it to 2 (measured: any threshold from
/// 1.5 to 1.95 serves); two steps running, as a sudden load can look like that once.
constexpr double alarming = 1.8;
constexpr unsigned alarms_needed = 2;
constexpr double low_safety = 0.5;
constexpr double max_over_bound = 1.4;
/// A search from random then ends within 250 steps.
constexpr std::uint64_t steps_per_portion = 4;

}  // namespace

void StepWatch::start() {
  if (is_implicit_) return soften();
  if (!scene_.solver.dt) {
    search(0);
    if (!std::isfinite(stable_) && built_.body().has_free_vertices())
      throw InputError(
          "/solver/dt: \"auto\" needs a model with forces, and there is none; give dt in seconds");
    return;
  }
  stable_ = bound(&StepLimits::bounds).value_or(0);
  if (*scene_.solver.dt > stable_) search(0);
}

/// Steps that are as soft as the scene allows.
void StepWatch::soften() {
  if (scene_.solver.softness) stable_ = built_.dynamics().step_of_softness(*scene_.solver.softness);
}

void StepWatch::after_event(std::uint64_t step) {
  if (is_implicit_) return soften();
  alarms_ = 0;
  interval_ = search_steps;
  if (warned_) return;  // nothing more to say
  const std::optional<double> local = bound(&StepLimits::bounds_of_changes);
  if (scene_.solver.dt) {
    if (!local || *scene_.solver.dt > *local) due_ = std::max(step, searched_ + search_steps);
  } else if (!local) {
    search(step);
  } else {
    const double changed = limit_over_bound_ * *local;
    lowest_change_ = std::min(lowest_change_, changed);
    if (!(changed < stable_)) return;
    stable_ = changed;
    lowered_ = step;
  }
}

void StepWatch::after_jump(std::uint64_t step) {
  if (is_implicit_) return soften();
  alarms_ = 0;
  interval_ = search_steps;
  search(step, true);
}

void StepWatch::after_step(std::uint64_t step) {
  if (halvings_ > 0 && step >= clean_since_ + (is_implicit_ ? implicit_steps : search_steps)) {
    --halvings_;
    clean_since_ = step;
  }
  if (!built_.limits().is_under_way() && step >= due_) begin(step);
  if (built_.limits().is_under_way() && step % steps_per_portion == 0) advance(step);
}

/// While events keep lowering the step, the bound takes the place of a search.
void StepWatch::begin(std::uint64_t step) {
  const bool is_auto = !scene_.solver.dt;
  const bool events_go_on = lowered_ > searched_ && step < lowered_ + search_steps;
  if (is_auto && events_go_on && step < searched_ + max_event_steps)
    aim_ = StepLimits::Aim::bound;
  else if (is_auto && !scene_.events.empty())
    aim_ = StepLimits::Aim::both;
  else
    aim_ = StepLimits::Aim::stable_step;
  found_before_ = searched_ >= lowered_ ? stable_ : 0;
  lowest_change_ = std::numeric_limits<double>::infinity();
  if (aim_ != StepLimits::Aim::bound) searched_ = step;
  if (!is_auto) due_ = never;  // until an event; else it begins again if is_unstable() ends it
  built_.limits().begin(aim_);
}

void StepWatch::advance(std::uint64_t step) {
  try {
    const std::optional<StepLimits::Found> found =
        built_.limits().advance(built_.dynamics().time());
    if (found) take(*found, step);
  } catch (const NoStepBound&) {
    if (!scene_.solver.dt) throw;  // a model without a bound runs with the user's dt
  }
}

void StepWatch::take(const StepLimits::Found& found, std::uint64_t step) {
  if (scene_.solver.dt) {
    stable_ = found.stable;
    compare();
  } else if (aim_ == StepLimits::Aim::bound) {
    stable_ = std::min(limit_over_bound_ * found.bound, lowest_change_);
    due_ = step + search_steps;
  } else {
    const bool same = std::abs(found.stable - found_before_) < 0.02 * found_before_;
    if (aim_ == StepLimits::Aim::both) keep_ratio(found.stable / found.bound);
    stable_ = std::min(found.stable, lowest_change_);
    interval_ = halvings_ > 0 ? reduced_search_steps
                : same        ? std::min(2 * interval_, max_search_steps)
                              : search_steps;
    due_ = step + interval_;
  }
}

void StepWatch::keep_ratio(double limit_over_bound) {
  limit_over_bound_ = std::clamp(limit_over_bound, 1.0, max_over_bound);
}

/// None if a model gives no bounds.
std::optional<double> StepWatch::bound(StepBounds (StepLimits::*which)(double)) {
  try {
    return (built_.limits().*which)(built_.dynamics().time()).dt;
  } catch (const NoStepBound&) {
    return std::nullopt;
  }
}

void StepWatch::search(std::uint64_t step, bool from_random) {
  if (is_implicit_) return;
  searched_ = step;
  due_ = scene_.solver.dt ? never : step + interval_;
  try {
    stable_ = built_.limits().stable_step(built_.dynamics().time(), from_random);
  } catch (const NoStepBound&) {
    if (!scene_.solver.dt) throw;
    return;  // a model without a bound runs with the user's dt
  }
  if (!scene_.solver.dt && !scene_.events.empty()) {
    keep_ratio(stable_ / bound(&StepLimits::bounds).value_or(stable_));
  }
  compare();
}

void StepWatch::compare() {
  if (warned_ || !scene_.solver.dt || !(*scene_.solver.dt > stable_)) return;
  warned_ = true;
  due_ = never;
  std::ostringstream text;
  text << "/solver/dt is " << *scene_.solver.dt
       << " s, which exceeds the stable step of the current state, " << stable_
       << " s; the run will become unstable. Reduce it, or use \"auto\"";
  diagnostics_.warn(text.str());
}

// ------------------------------------------------------------------- alarms --

bool StepWatch::is_alarming(std::uint64_t step) {
  if (is_implicit_) return false;
  alarms_ = built_.dynamics().motion().sums().apparent_frequency() > alarming ? alarms_ + 1 : 0;
  return alarms_ >= alarms_needed && step >= trusted_until_;
}

bool StepWatch::is_unstable(std::uint64_t step, double dt) {
  const double known = stable_;
  try {
    stable_ = built_.limits().stable_step(built_.dynamics().time(), true);
  } catch (const Error&) {
    stable_ = 0;  // no model says, or the state is beyond its law
  }
  searched_ = step;
  const bool unstable = !(dt < stable_);
  if (unstable) {
    stable_ = std::min(known, stable_);
  } else {
    trusted_until_ = step + search_steps;
  }
  return unstable;
}

void StepWatch::search_for_report() {
  if (is_implicit_) return;
  try {
    stable_ = built_.limits().stable_step(built_.dynamics().time(), true);
  } catch (const Error&) {
    stable_ = 0;
  }
}

void StepWatch::roll_back(std::uint64_t step, unsigned halvings) {
  halvings_ += halvings;
  alarms_ = 0;
  clean_since_ = step;
  interval_ = reduced_search_steps;
  trusted_until_ = 0;
  if (!scene_.solver.dt) search(step, true);
}

double StepWatch::wanted() const {
  const double dt = std::ldexp(safety_ * stable_, -static_cast<int>(halvings_));
  const double time = built_.dynamics().time();
  const ContactLaw* contact = built_.body().contact();
  const double longest = contact ? contact->longest_step(time) : dt;
  return std::min({dt, built_.body().constraints().longest_step(time), longest});
}

bool StepWatch::lower_safety() {
  if (scene_.solver.dt || safety_ <= low_safety) return false;
  safety_ = low_safety;
  return true;
}

void StepWatch::state(Archive& archive) {
  archive("safety", safety_);
  archive("stable", stable_);
  archive("halvings", halvings_);
  archive("searched", searched_);
  archive("aim", aim_);
  archive("found before", found_before_);
  archive("lowest change", lowest_change_);
  archive("due", due_);
  archive("interval", interval_);
  archive("limit over bound", limit_over_bound_);
  archive("lowered", lowered_);
  archive("clean since", clean_since_);
  archive("trusted until", trusted_until_);
  archive("alarms", alarms_);
  archive("warned", warned_);
}

}  // namespace suture
