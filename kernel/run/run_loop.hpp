// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <optional>

#include "kernel/implicit/newton.hpp"
#include "kernel/operations/event_runner.hpp"
#include "kernel/results/event_report.hpp"
#include "kernel/results/records.hpp"
#include "kernel/run/checkpoints.hpp"
#include "kernel/run/decisions.hpp"
#include "kernel/run/ending.hpp"
#include "kernel/run/run_report.hpp"
#include "kernel/run/sleeper.hpp"
#include "kernel/steps/step_control.hpp"

namespace suture {

class Communicator;

/// The main loop of a run over a built scene. At each time the order is events, records, step: a
/// frame shows the effect of events at its time.
class RunLoop {
 public:
  RunLoop(const Scene& scene, PluginHost& host, Diagnostics& diagnostics, bool skip,
          std::shared_ptr<OutputFolder> folder, bool check_plugins = false,
          Communicator* processes = nullptr);

  // The functions of Simulation with these names.
  std::optional<RunSummary::Outcome> advance(const Pause& pause, Observer& observer);
  RunSummary run(Observer& observer);
  EventOutcome apply(const Event& event, Observer& observer);
  void change_motion(const std::function<void(Attributes&)>& change);
  void steer(const std::string& obstacle, const PoseTarget& target);
  void move_grasp(const std::string& grasp, const Vec3& translation, double duration);
  ForceTerm& add_term(std::unique_ptr<ForceTerm> term);
  void set_parameters(Instance& instance, std::vector<double> values);
  void set_field(Instance& instance, std::size_t parameter, std::vector<double> values);
  void set_gravity(const Vec3& value);
  void equilibrate(Observer& observer);
  StateTree save(StateTree* spare);
  void load(const StateTree& state);
  /// Loads the state of the checkpoint from `file`. Call before any step.
  void resume(const Checkpoint& checkpoint, const std::filesystem::path& file);
  /// Builds what the events of the scene need, unless that has been done (EventRunner). Steps and
  /// events need no call.
  void make_ready();
  /// Makes a step for timing only, without events; returns false if it fails.
  bool try_step();
  /// Event `event` as if it were `time`, without a message; only for estimates.
  void rehearse(std::size_t event, double time);

  BuiltScene& built() { return built_; }
  const EventRunner& events() const { return events_; }
  Recorder& recorder() { return recorder_; }
  Records& records() { return records_; }
  StepControl& control() { return control_; }
  const StepControl& control() const { return control_; }
  Ending& ending() { return ending_; }
  const std::vector<Decision>& decisions() const { return decisions_; }

  /// Everything that a run changes, as it is between two steps.
  void state(Archive& archive);

 private:
  void change_forces(const std::function<void()>& change);
  void change_parameters(const std::function<void()>& set, const std::function<void()>& undo);
  using Wall = std::chrono::steady_clock;
  void share(Communicator& processes);
  void require_held_bodies();
  std::optional<RunSummary::Outcome> loop(const Pause& pause, Observer& observer);
  void close_failed(Observer& observer);
  bool fire_events(Observer& observer, const StepControl::Notify& notify);
  bool fire_due_events(Observer& observer, const StepControl::Notify& notify);
  void report(std::size_t event, const EventOutcome& outcome, Observer& observer);
  void skip(std::size_t event, const Error& error);
  bool stops_at_failure(const Event& event) const;
  bool balance(const StepControl::Notify& notify);
  void find_equilibrium(const StepControl::Notify& notify);
  void take_over(const EventOutcome& outcome);
  void report_sleep(Observer& observer);
  bool record(const StepControl::Notify& notify);
  bool stops(Observer& observer);
  void report_progress(Observer& observer, const Newton::Iteration* iteration = nullptr);
  bool record_end(Observer& observer);
  void finish(Observer& observer);
  void summarise();
  void check_bounds();
  std::string describe_solver();

  PluginHost& host_;
  Diagnostics& diagnostics_;
  BuiltScene built_;
  const Scene& scene_ = built_.scene();  ///< in the frame of the body
  EventRunner events_;
  Recorder recorder_;
  EventSchedule schedule_;
  EventReport event_report_{scene_.events};
  StepControl control_;
  const Clock& clock_ = control_.clock();
  Records records_;
  Sleeper sleeper_;
  Ending ending_;
  Checkpoints checkpoints_;
  std::vector<Decision> decisions_;
  RunSummary summary_;
  bool is_ready_ = false;                  ///< make_ready()
  std::vector<std::uint8_t> was_skipped_;  ///< by event: it has been reported
  bool is_unbalanced_ = false;             ///< something has changed since the last step
  std::uint64_t first_step_ = 0;           ///< not 0 if the run was resumed
  Wall::time_point began_{};               ///< the call of advance()
  std::uint64_t began_at_ = 0;             ///< its first step
  Wall::time_point reported_{};            ///< the last progress
  Communicator* processes_;
};

}  // namespace suture
