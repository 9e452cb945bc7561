// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>

#include "kernel/live/device_hand.hpp"
#include "kernel/live/live_server.hpp"
#include "kernel/live/live_states.hpp"
#include "kernel/live/picture.hpp"
#include "kernel/live/recording.hpp"
#include "kernel/output/checkpoint_file.hpp"
#include "kernel/run/simulation.hpp"

namespace suture {

/// What changes a scene into one that is watched: it writes no results (a repetition of the
/// recording does), but makes the same steps as a run that does.
void leave_out_results(Scene& scene);

/// A run that pages show and control. It starts paused. Inputs are JSON objects (docs/live.md).
/// They act between two steps and are recorded; a run that has failed shows its last state until it
/// goes back to an earlier one.
class LiveRun {
 public:
  /// Throws the errors of Simulation and of the recording, which is written to `recording` ("": a
  /// name of its own).
  LiveRun(const Scene& scene, PluginHost& host, Diagnostics& diagnostics, LiveServer& server,
          std::filesystem::path recording);
  /// The same for a simulation that belongs to a script, which has made `done` before; it must
  /// outlive this. Pages cannot go back to earlier states. `recording` may be none.
  LiveRun(Simulation& simulation, const Scene& scene, PluginHost& host, Diagnostics& diagnostics,
          LiveServer& server, std::optional<std::filesystem::path> recording,
          std::span<const RecordedInput> done);
  ~LiveRun();

  /// Goes on from a checkpoint of the same scene, read from `file`, and what mouse or device held
  /// there is released; a reset returns to it. Call before anything else. Throws InputError if it
  /// does not fit.
  void resume(Checkpoint checkpoint, const std::filesystem::path& file, Observer& observer);
  /// Makes the steps of a recording with its inputs, which are recorded again. Call before run().
  /// Throws the errors of repeat(). False if `observer` has stopped it.
  bool continue_from(const Recording& recording, Observer& observer);
  /// Goes on, at first paused, until `observer` requests a stop. Throws IoError of the recording.
  void run(Observer& observer);
  /// Ends the recording. Throws IoError.
  void end();

  // ---- between two calls of run(): the script makes the steps ----

  /// Shows the state if a picture is due; pages watch only. Call before each step.
  void watch();
  /// Shows the state, also to a page that comes later. Call after the last of some steps, or an
  /// input.
  void show_last();
  /// An input that the script has applied.
  void record(const RecordedInput& input);
  /// The script did what no recording can repeat: it ends here.
  void stop_recording(const std::string& why);
  void report(const std::string& message) { tell("message", message); }

  bool has_failed() const { return status_.has_failed; }
  /// The exit code of the program (Error::exit_code()): 0 unless the run has failed.
  int exit_code() const { return has_failed() ? failure_code_ : 0; }
  Simulation& simulation() { return *simulation_; }
  const RecordingWriter& recording() const { return *recording_; }
  /// From now on a device moves what it holds (DeviceHand) while the run plays. It must outlive
  /// this. Throws the errors of DeviceHand.
  void follow(Device& device, std::string obstacle);

 private:
  using Wall = std::chrono::steady_clock;
  class Reporter;
  void build(std::uint64_t first_surface, const StateTree* state);
  void take(std::unique_ptr<Simulation> simulation, std::unique_ptr<Pictures> pictures);
  void make_due_steps(Observer& observer);
  void make_steps(std::uint64_t count, Observer& observer);
  void require_own(const std::string& what) const;
  void fail(const Error& error);
  void copy_if_due();
  void remove_failed_piece(Observer& observer);
  void show();
  bool has_just_acted() const;
  void catch_up();
  void measure(std::uint64_t steps, double simulated);
  void report_warnings();
  void tell(const char* key, const std::string& text);
  void tell_lists();
  void feel_hand();

  // ---- device: live_device.cpp ----
  void engage_device();
  void move_device_hand(double steps, Observer& observer);
  void feel();
  void show_device();

  // ---- inputs: live_inputs.cpp ----
  using Json = nlohmann::json;
  void obey(const std::string& text, Observer& observer);
  bool control(const std::string& what, const Json& input, Observer& observer);
  void act(const std::string& what, const Json& input, Observer& observer);
  void play(bool plays);
  std::optional<std::vector<RecordedInput>> all_inputs() const;
  void send_scene();
  void save_checkpoint();
  void make_divisible(Observer& observer);
  void reset(Observer& observer);
  void go_back(const Json& input, Observer& observer);
  LiveState state_now(StateTree spare);
  void keep(const std::string& name, bool is_before_action);
  void keep(LiveState state, const std::string& name, bool is_before_action);
  void aim();
  void as_action(const std::string& name, const std::function<void()>& action,
                 bool is_aimed = false);
  void apply(const std::string& value, Observer& observer, const std::string& device = "page");
  void grab(const Vec3& at, Observer& observer);
  void take_tool(const std::string& tool, const Vec3& at, Observer& observer);
  void drag(const Vec3& to, Observer& observer);
  void let_go(Observer& observer);

  const Scene* scene_;  ///< that of the caller, or divisible_
  std::unique_ptr<Scene> divisible_;
  PluginHost& host_;
  Diagnostics& diagnostics_;
  LiveServer& server_;
  std::unique_ptr<Simulation> own_;
  Simulation* simulation_ = nullptr;    ///< own_, or that of a script
  std::unique_ptr<Pictures> pictures_;  ///< they refer to the simulation
  std::optional<RecordingWriter> recording_;
  CheckpointHeader header_;         ///< of checkpoints of a run of its own
  std::optional<StateTree> start_;  ///< if it began at a checkpoint
  /// Inputs before the checkpoint at which it began, if that says so.
  std::optional<std::vector<RecordedInput>> earlier_{std::in_place};
  std::string field_ = "displacement";
  LiveStatus status_;
  bool is_shown_ = false;
  bool lacks_curves_ = false;  ///< the last picture
  std::optional<Hand> hand_;
  Device* device_ = nullptr;
  std::string device_obstacle_;
  std::optional<DeviceHand> device_hand_;
  LiveStates kept_;
  std::optional<LiveState> aimed_;  ///< that of aim()
  /// A state of the last seconds, from which the steps to a failure are made again.
  std::optional<LiveState> recent_;
  Wall::time_point next_recent_;
  int failure_code_ = 0;
  std::size_t reported_warnings_ = 0;
  std::string reported_problem_;  ///< of the recording
  /// Where and when playing began, which the speed counts from.
  double played_from_ = 0;
  Wall::time_point playing_since_, next_picture_, next_unwatched_, acted_;
  double seconds_per_step_ = 0, dt_ = 0;
  /// Since status_ was last measured.
  struct Measured {
    Wall::time_point since;
    std::uint64_t steps = 0, exchanges = 0;
    double simulated = 0;
  } measured_;
};

}  // namespace suture
