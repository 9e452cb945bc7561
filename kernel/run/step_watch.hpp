// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "kernel/base/diagnostics.hpp"
#include "kernel/scene/built_scene.hpp"
#include "kernel/scene/scene.hpp"

namespace suture {

/// Knows the stable step of a run, and how much of it is used. A search
/// (StepLimits::stable_step()) costs as much as 150 evaluations of the forces from random, 15
/// where it goes on from the last one, 27 or more where the cells are others since; the bound on
/// its safe side of all vertices 22, of those that an event changed what the event touched.
///  - A fixed dt below the bounds needs no search. An event that takes the bound of the
///    vertices it changed below dt is followed by one, at most every 512 steps.
///  - "auto" searches at the start, after 512 steps, and then after twice as many as before
///    while the step stays the same within 2 %, 8192 at most. An event lowers the step to the
///    bound of the vertices that it changed, if that is less: elsewhere nothing is different,
///    and the step was stable there. The bound is 0.6 to 0.75 of the limit; it is taken times
///    what the search found over what the bound said of the whole body then.
///  - While events go on to lower the step, a search would be out of date at once. Every 512
///    steps the bound of all vertices takes its place (4 %), which follows the state both
///    ways; a search comes when 512 steps have passed without such an event, and at the latest
///    4096 steps after the one before (4 %). So a blade that cuts in every step costs a
///    shorter step, and neither a search for each cut nor a run without any.
///  - What the search does not see in time, the frequency of the motion does (is_alarming());
///    the step is halved then, searched every 64 steps, and doubled after 512 without an alarm.
/// Counted in steps, not seconds, so that a run is the same on every machine.
class StepWatch {
 public:
  StepWatch(const Scene& scene, BuiltScene& built, Diagnostics& diagnostics)
      : scene_(scene), built_(built), diagnostics_(diagnostics), safety_(scene.solver.safety) {}

  /// Throws PluginError or InputError if "auto" has nothing to go by.
  void start();
  /// The cells are others since `step` steps.
  void after_event(std::uint64_t step);
  void after_step(std::uint64_t step);
  /// Now, whatever dt is; `from_random`: overlooks no mode.
  void search(std::uint64_t step, bool from_random = false);

  /// The motion of the last two steps is that of an unstable step. O(1).
  bool is_alarming(std::uint64_t step);
  /// After an alarm: false if dt is stable, by a search from random, in the present state; it is
  /// not asked again for 512 steps then.
  bool is_unstable(std::uint64_t step, double dt);
  /// For the last words of a run: the stable step of the present state, from
  /// random; 0 if no model says.
  void look_again();
  /// A step was rejected, and the state of `step` is the present one: dt is halved
  /// `halvings` times.
  void step_back(std::uint64_t step, unsigned halvings);
  unsigned halvings() const { return halvings_; }

  /// The stable step, s, or with a fixed dt what is known of it: a bound, 0 if nothing.
  /// Infinite where every vertex is prescribed.
  double stable() const { return stable_; }
  /// What "auto" makes of it, s: safety and halvings included, and that prescribed motion moves
  /// no vertex by more than a tenth of an element.
  double wanted() const;
  /// Half the stable step from now on, if it is more. False if it is not.
  bool lower_safety();
  void state(Archive& archive);

 private:
  static constexpr std::uint64_t search_steps = 512, most_search_steps = 16 * search_steps,
                                 most_event_steps = 8 * search_steps, reduced_search_steps = 64,
                                 never = ~std::uint64_t{0};

  std::optional<double> bound(StepBounds (StepLimits::*which)(double));
  void compare();

  const Scene& scene_;
  BuiltScene& built_;
  Diagnostics& diagnostics_;
  double safety_;
  double stable_ = 0;
  unsigned halvings_ = 0;
  std::uint64_t searched_ = 0, due_ = never, interval_ = search_steps;
  double limit_over_bound_ = 1;    ///< at the last search, 1 to most_over_bound
  std::uint64_t lowered_ = 0;      ///< the step at which an event last lowered stable_
  std::uint64_t clean_since_ = 0;  ///< last alarm, or halving taken back
  std::uint64_t trusted_until_ = 0;
  unsigned alarms_ = 0;  ///< steps running
  bool warned_ = false;
};

}  // namespace suture
