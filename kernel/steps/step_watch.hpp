// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "kernel/base/diagnostics.hpp"
#include "kernel/build/built_scene.hpp"
#include "kernel/scene/scene.hpp"

// What makes a step unstable
// ==========================
//
// The indicator is the apparent frequency of the motion, w^2 = -dx . df / (dx . M dx) (Park and
// Underwood, 1980). Its three sums come from passes that are made anyway, per 1024 vertices; they
// cost 0.3 % of a step.
//
//   h w   0 ........ 1.3 ..... 1.8 .... 2
//         valid motion       | alarm   | an unstable mode
//
// Any threshold from 1.5 to 1.95 works. If h w exceeds it in two consecutive steps, the stable
// step is computed again from a random start. If dt is above it, the run rolls back. Vertices that
// move by less than rounding do not count.
//
// Five scenes that all used to fail are a hanging block, a stretch by 40 %, a sudden traction,
// stiffening fibres, and a point load in 13,800 elements. They finish with 1 to 3 rollbacks and 30
// to 99 rejected steps, as close to a run at safety 0.05 as an undisturbed run at 0.4.
//
// After an event, the bound around the affected vertices is multiplied by at most 1.4. Without
// that factor, 80 cuts made runs a third longer. With 1.7, nine of 140 runs with cuts and tears
// were stopped, with 1.4 three. A search from a random start that is spread over steps ends within
// 250 of them; it is part of checkpoints.

namespace suture {

/// Keeps the stable step of a run, and the fraction of it that is used. A search
/// (StepLimits::stable_step()) costs 150 evaluations of the forces from a random start, 15 if it
/// continues from the last one, and at least 27 if the cells have changed since; the conservative
/// bound costs 22 for all vertices, and for the vertices that an event changed only as much as the
/// cells affected.
///  - A fixed dt below the bounds needs no search. An event that takes the bound of the vertices
///    it changed below dt is followed by a search, at most every 512 steps.
///  - "auto" searches at the start, after 512 steps, and then after intervals that double, up to
///    8192 steps, as long as the result does not change by more than 2 %. An event lowers the step
///    to the bound of the vertices that it changed, if that is less: nothing has changed elsewhere,
///    where the step was stable. The bound is 0.6 to 0.75 of the limit; it is multiplied by the
///    ratio of the last search to the bound of the whole body at that time.
///  - While events keep lowering the step, a search would be out of date at once. Every 512 steps
///    the bound of all vertices replaces it (4 %), which follows the state in both directions; a
///    search is made once 512 steps have passed without such an event, and at the latest 4096 steps
///    after the previous one (4 %). So a blade that cuts in every step costs a shorter step, but
///    neither a search for each cut nor a run without any.
///  - A search or a bound of all vertices that falls due is spread over the following steps: after
///    every fourth step one product with the tangent, or the bounds of a 64th of the vertices. So
///    no step takes long (a haptic device waits for it). Events in the meantime lower the result as
///    they lower the step. The first search and those after alarms and rollbacks are made at once.
///  - The frequency of the motion reveals what the search does not find in time (is_alarming());
///    the step is then halved, searched every 64 steps, and doubled after 512 without an alarm.
/// An implicit integrator needs none of this: its steps are stable, and are halved only where their
/// equations have no solution within reach.
/// Intervals are counted in steps, not seconds, so that a run is the same on every machine.
class StepWatch {
 public:
  StepWatch(const Scene& scene, BuiltScene& built, Diagnostics& diagnostics)
      : scene_(scene),
        built_(built),
        diagnostics_(diagnostics),
        is_implicit_(built.dynamics().is_implicit()),
        safety_(scene.solver.safety),
        stable_(is_implicit_ ? std::numeric_limits<double>::infinity() : 0) {}

  /// Throws PluginError or InputError if "auto" cannot determine a step.
  void start();
  /// Call after an event changed the cells at step `step`.
  void after_event(std::uint64_t step);
  /// Call after the motion or the forces were changed from outside.
  void after_jump(std::uint64_t step);
  void after_step(std::uint64_t step);
  /// Searches now, whatever dt is. `from_random`: overlooks no mode.
  void search(std::uint64_t step, bool from_random = false);

  /// True if the motion of the last two steps is that of an unstable step. O(1).
  bool is_alarming(std::uint64_t step);
  /// After an alarm: false if a search from a random start finds dt stable in the current state;
  /// alarms are then ignored for 512 steps.
  bool is_unstable(std::uint64_t step, double dt);
  /// For the final message of a run: finds the stable step of the current state from a random
  /// start; 0 if no model provides it.
  void search_for_report();
  /// Call when a step was rejected and the run is back at `step`: dt is halved `halvings` times.
  void roll_back(std::uint64_t step, unsigned halvings);
  /// Call after a step that has not passed the place of the last failure yet: dt is not doubled.
  void stay(std::uint64_t step) { clean_since_ = step; }
  unsigned halvings() const { return halvings_; }

  /// The stable step, s; with a fixed dt, a known bound on it, or 0.
  /// Infinite where every vertex is prescribed, and for implicit integrators.
  double stable() const { return stable_; }
  /// The step chosen by "auto", s: with safety and halvings, and such that prescribed motion moves
  /// no vertex, and no obstacle, by more than a tenth of an element.
  double wanted() const;
  /// Limits the step to half the stable step from now on. Returns false if it is already that low.
  bool lower_safety();
  void state(Archive& archive);

 private:
  static constexpr std::uint64_t search_steps = 512, max_search_steps = 16 * search_steps,
                                 max_event_steps = 8 * search_steps, reduced_search_steps = 64,
                                 implicit_steps = 4, never = ~std::uint64_t{0};

  std::optional<double> bound(StepBounds (StepLimits::*which)(double));
  void soften();
  void begin(std::uint64_t step);
  void advance(std::uint64_t step);
  void take(const StepLimits::Found& found, std::uint64_t step);
  void keep_ratio(double limit_over_bound);
  void compare();

  const Scene& scene_;
  BuiltScene& built_;
  Diagnostics& diagnostics_;
  bool is_implicit_;
  double safety_;
  double stable_;
  unsigned halvings_ = 0;
  std::uint64_t searched_ = 0;  ///< the step at which the last search began
  std::uint64_t due_ = never, interval_ = search_steps;
  StepLimits::Aim aim_{};          ///< of what is under way
  double found_before_ = 0;        ///< s: stable_ when it began; 0 if events had lowered it
  double lowest_change_ = 0;       ///< s: the bound around changes since then, as used for stable_
  double limit_over_bound_ = 1;    ///< at the last search, between 1 and max_over_bound
  std::uint64_t lowered_ = 0;      ///< the step at which an event last lowered stable_
  std::uint64_t clean_since_ = 0;  ///< the last alarm or undone halving
  std::uint64_t trusted_until_ = 0;
  unsigned alarms_ = 0;  ///< consecutive steps
  bool warned_ = false;
};

}  // namespace suture
