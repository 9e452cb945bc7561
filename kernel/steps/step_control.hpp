// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "kernel/dynamics/clock.hpp"
#include "kernel/operations/event_runner.hpp"
#include "kernel/operations/event_schedule.hpp"
#include "kernel/results/recorder.hpp"
#include "kernel/steps/failed_piece.hpp"
#include "kernel/steps/guard.hpp"
#include "kernel/steps/kept_states.hpp"
#include "kernel/steps/step_accuracy.hpp"
#include "kernel/steps/step_watch.hpp"

namespace suture {

/// The motion shows that the step is unstable.
class UnstableStep : public NumericalError {
 public:
  using NumericalError::NumericalError;
};

/// Steps have become too short to reach the tolerance of their error.
class InaccurateStep : public NumericalError {
 public:
  using NumericalError::NumericalError;
};

/// Makes the steps of a run and verifies them: a step that turns out to be wrong (its motion is
/// unstable, a model asks for a smaller step, values are not finite, elements invert) is repeated
/// from a state 32 to 64 steps earlier, with half the step. A step whose error is too large is
/// repeated at once, from its own start. A failure that no smaller step
/// resolves, or that a fixed dt does not allow to resolve, ends the run with its cause, advice that
/// fits the scene, and two frames: the last good state and the one that failed.
class StepControl {
 public:
  using Notify = std::function<void(const std::string&)>;

  StepControl(const Scene& scene, BuiltScene& built, Recorder& recorder, EventSchedule& schedule,
              EventRunner& events, Clock clock, Diagnostics& diagnostics);

  /// Call after Dynamics::start(). Throws PluginError or InputError if "auto" cannot determine a
  /// step.
  void start();

  const Clock& clock() const { return clock_; }
  const Guard& guard() const { return guard_; }
  StepWatch& watch() { return watch_; }
  double last_dt() const { return last_dt_; }             ///< s
  std::uint64_t rollbacks() const { return rollbacks_; }  ///< the number of rollbacks
  /// How steps follow their error, or nullptr if they do not.
  const StepAccuracy* accuracy() const { return accuracy_ ? &*accuracy_ : nullptr; }
  double next_dt();

  /// Makes one step, after everything due at its start, or rolls back to an earlier state. Throws
  /// NumericalError for a final failure.
  void step(const Notify& notify);
  /// Finds the equilibrium at the current time once more, after a change of the cells or the
  /// forces. Throws NumericalError if there is none: a smaller step is none at all.
  void balance();
  /// Called for each step that follows its error, for `suture run -v`.
  Notify on_detail{};
  /// Asked while equations are solved: if true, step() and balance() throw StepAbandoned, and the
  /// run is as it was before the step. None: nobody is asked.
  std::function<bool()> is_abandoned{};
  /// Makes a step without checks, for estimates.
  void make_step();
  /// Calls `check` on the current state, which may evaluate forces there and fail like a step;
  /// returns false if the run rolled back instead.
  bool try_check(const std::function<void()>& check, const Notify& notify);
  /// The state between two steps is at fault, as `error` says: goes back to an earlier one, or
  /// throws what is final.
  void take_back(const NumericalError& error, const Notify& notify);
  /// Checks the last state; returns false if the run rolled back instead.
  bool check_last_state(const Notify& notify);

  /// A warning if the balance of the whole run did not close; otherwise "".
  std::string balance_warning() const;

  /// Where the run has failed, if it did so at a small piece.
  const std::optional<FailedPiece>& failed_piece() const { return failed_piece_; }

  /// Call after an operation has changed the cells. O(affected cells).
  void after_event();
  /// Call after the motion or the forces were changed from outside.
  void after_jump();
  /// Call after any other change that cannot be undone: recorded data become final.
  void commit();

  /// The state of the run up to the current step, for rollbacks and, with more data, for
  /// checkpoints. Records and events have their own states.
  void state(Archive& archive);

 private:
  void make_one_step();
  void step_body(double dt);
  void make_accurate_step();
  bool try_accurate_step();
  void tell_step(double start, const std::string& judgement) const;
  [[noreturn]] void refuse_step(const StepError& step);
  void check_contact() const;
  void check_step(const Notify& notify);
  void check_state(const Notify& notify);
  bool should_retry_smaller();
  void roll_back(const NumericalError& error, const Notify& notify);
  void restore(const KeptStates::State& kept);
  std::vector<Index> elements_now(std::uint64_t number) const;
  [[noreturn]] void give_up(const NumericalError& error);
  std::string advice(const NumericalError& error) const;
  const char* step_setting() const;
  bool may_use_newmark() const;

  const Scene& scene_;
  BuiltScene& built_;
  Recorder& recorder_;
  EventSchedule& schedule_;
  EventRunner& events_;
  Diagnostics& diagnostics_;
  Clock clock_;
  Guard guard_;
  StepWatch watch_;
  std::optional<StepAccuracy> accuracy_;
  LocalError error_;
  StateBuffer before_;  ///< the state at the start of a step that follows its error
  KeptStates kept_;
  double last_dt_ = 0;
  double latest_failure_time_ = -1;  ///< s
  unsigned attempts_ = 0;            ///< to pass it
  double last_growth_ = 0;           ///< at the previous check
  double latest_growth_time_ = -1;   ///< s
  unsigned growth_attempts_ = 0;     ///< to pass it
  bool growth_was_reported_ = false;
  std::uint64_t rollbacks_ = 0;
  std::optional<FailedPiece> failed_piece_;
};

}  // namespace suture
