// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "kernel/dynamics/clock.hpp"
#include "kernel/events/event_runner.hpp"
#include "kernel/events/event_schedule.hpp"
#include "kernel/run/guard.hpp"
#include "kernel/run/kept_states.hpp"
#include "kernel/run/recorder.hpp"
#include "kernel/run/step_watch.hpp"

namespace suture {

/// The motion is that of an unstable step.
class UnstableStep : public NumericalError {
 public:
  using NumericalError::NumericalError;
};

/// Makes the steps of a run and vouches for them: a step that turns out to be wrong (its
/// motion is unstable, a model asks for a smaller one, numbers are not finite, elements turn
/// inside out) is made again from a state some 32 to 64 steps before, with half the step. What no
/// smaller step mends, or what a fixed dt forbids, ends the run with its cause, advice that fits
/// the scene, and two frames: the last good state and the one that failed.
class StepControl {
 public:
  using Notify = std::function<void(const std::string&)>;

  StepControl(const Scene& scene, BuiltScene& built, Recorder& recorder, EventSchedule& schedule,
              EventRunner& events, Clock clock, Diagnostics& diagnostics);

  /// After Dynamics::start(). Throws PluginError or InputError if "auto" has nothing to go by.
  void start();

  const Clock& clock() const { return clock_; }
  const Guard& guard() const { return guard_; }
  StepWatch& watch() { return watch_; }
  double last_dt() const { return last_dt_; }               ///< s
  std::uint64_t steps_back() const { return steps_back_; }  ///< how often
  double next_dt();

  /// One step, with all done that is due at its beginning; or back to an earlier state. Throws
  /// NumericalError for what is final.
  void step(const Notify& notify);
  /// A step without a second look, for estimates.
  void make_step();
  /// Looks at the present state with `look`, which may evaluate forces there and fail as a step
  /// does; false if it went back instead.
  bool tries(const std::function<void()>& look, const Notify& notify);
  /// Looks at the last state; false if it went back instead.
  bool ends_well(const Notify& notify);

  /// A warning if the balance of the whole run did not close, and nothing was said of it; or "".
  std::string balance_warning() const;

  /// An operation has changed the cells. O(what it touched).
  void after_event();
  /// Something else has happened that cannot be undone: what is recorded stays.
  void commit();

  /// Everything of the run up to the step in progress: what it goes back to, and more of a
  /// checkpoint. Records and events have states of their own.
  void state(Archive& archive);

 private:
  void check_step(const Notify& notify);
  void check_state(const Notify& notify);
  bool is_worth_a_smaller_step();
  void step_back(const NumericalError& error, const Notify& notify);
  void restore(const KeptStates::State& kept);
  [[noreturn]] void give_up(const NumericalError& error);
  std::string advice(const NumericalError& error) const;

  const Scene& scene_;
  BuiltScene& built_;
  Recorder& recorder_;
  EventSchedule& schedule_;
  EventRunner& events_;
  Diagnostics& diagnostics_;
  Clock clock_;
  Guard guard_;
  StepWatch watch_;
  KeptStates kept_;
  double last_dt_ = 0;
  double furthest_failure_ = -1;  ///< s
  unsigned attempts_ = 0;         ///< to pass it
  double last_growth_ = 0;        ///< at the look before
  double furthest_growth_ = -1;   ///< s
  unsigned growth_attempts_ = 0;  ///< to pass it
  bool growth_was_reported_ = false;
  std::uint64_t steps_back_ = 0;
};

}  // namespace suture
