// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <optional>

#include "apps/suture/commands.hpp"
#include "apps/suture/signals.hpp"
#include "kernel/live/live_run.hpp"
#include "kernel/output/checkpoint_file.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture {
namespace {

class LiveObserver final : public Observer {
 public:
  explicit LiveObserver(Console& console) : console_(console) {}
  void on_message(const std::string& message) override { console_.note(message); }
  void on_detail(const std::string& message) override {
    if (console_.verbose()) console_.note(message);
  }
  bool stop_requested() override { return caught_signal() != 0; }
  bool gives_up_step() override { return stop_requested(); }

 private:
  Console& console_;
};

/// What the command names: a scene, a recording, or a checkpoint, where a recording may begin.
struct Start {
  std::optional<Recording> recording;
  std::optional<Checkpoint> checkpoint;
  std::filesystem::path checkpoint_file;

  explicit Start(const std::filesystem::path& file) {
    if (is_recording(file)) {
      recording = read_recording(file);
      checkpoint_file = recording->checkpoint;
    } else if (is_checkpoint(file)) {
      checkpoint_file = file;
    }
    if (!checkpoint_file.empty()) checkpoint = read_checkpoint(checkpoint_file);
  }
};

Scene read_start(const Start& start, const std::filesystem::path& file,
                 const std::vector<std::string>& sets, PluginHost& host, Diagnostics& diagnostics) {
  if (start.recording) return read_scene_source(start.recording->source, sets, host, diagnostics);
  if (!start.checkpoint) return read_scene(file, sets, host, diagnostics);
  const CheckpointHeader& header = start.checkpoint->header;
  return read_scene_source({header.scene_text, header.scene_file, header.working_folder, {}}, sets,
                           host, diagnostics);
}

/// Who watches a run decides when it ends. An end that the user gives stays, as does that of a
/// recording; static runs and runs until rest have their own.
Scene open_scene(const Start& start, const LiveCommand& command, PluginHost& host,
                 Diagnostics& diagnostics) {
  Scene scene = read_start(start, command.scene, command.sets, host, diagnostics);
  const bool is_given = std::ranges::any_of(
      command.sets, [](const std::string& set) { return set.starts_with("/solver/end="); });
  if (!start.recording && scene.solver.end && scene.solver.integrator != "static" && !is_given) {
    std::vector<std::string> sets = command.sets;
    sets.emplace_back("/solver/end=1e6");
    Diagnostics repeated;
    scene = read_start(start, command.scene, sets, host, repeated);
  }
  leave_out_results(scene);
  return scene;
}

}  // namespace

int live(const LiveCommand& command, Console& console) {
  catch_signals();
  PluginHost host(&console.diagnostics());
  Start start(command.scene);
  const Scene scene = open_scene(start, command, host, console.diagnostics());
  const auto server = open_live_server(static_cast<std::uint16_t>(command.port), command.host);
  std::optional<Device> device;
  if (!command.device.empty()) device.emplace(command.device);
  LiveRun run(scene, host, console.diagnostics(), *server, command.recording);
  if (device) run.follow(*device, command.hold);
  has_started();
  LiveObserver observer(console);
  if (start.checkpoint) run.resume(std::move(*start.checkpoint), start.checkpoint_file, observer);
  if (start.recording && !run.continue_from(*start.recording, observer)) return 0;
  console.print(
      (command.host.empty() ? "open in a browser on this machine: " : "open in a browser: ") +
      server->address());
  if (!command.host.empty())
    console.note("who has this address controls the run; what is sent is not encrypted");
  std::fflush(stdout);
  run.run(observer);
  run.end();
  if (run.recording().has_inputs())
    console.print("repeat with: suture run " + run.recording().path().string());
  return run.exit_code();
}

}  // namespace suture
