// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <optional>

#include "apps/suture/commands.hpp"
#include "apps/suture/signals.hpp"
#include "kernel/live/live_run.hpp"
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

 private:
  Console& console_;
};

/// Who watches a run decides when it ends. An end that the user gives stays; static runs and runs
/// until rest have their own.
Scene open_scene(const LiveCommand& command, PluginHost& host, Diagnostics& diagnostics) {
  Scene scene = read_scene(command.scene, command.sets, host, diagnostics);
  const bool is_given = std::ranges::any_of(
      command.sets, [](const std::string& set) { return set.starts_with("/solver/end="); });
  if (scene.solver.end && scene.solver.integrator != "static" && !is_given) {
    std::vector<std::string> sets = command.sets;
    sets.emplace_back("/solver/end=1e6");
    Diagnostics repeated;
    scene = read_scene(command.scene, sets, host, repeated);
  }
  leave_out_results(scene);
  return scene;
}

}  // namespace

int live(const LiveCommand& command, Console& console) {
  catch_signals();
  PluginHost host(&console.diagnostics());
  const Scene scene = open_scene(command, host, console.diagnostics());
  const auto server = open_live_server(static_cast<std::uint16_t>(command.port), command.host);
  std::optional<Device> device;
  if (!command.device.empty()) device.emplace(command.device);
  LiveRun run(scene, host, console.diagnostics(), *server, command.recording);
  if (device) run.follow(*device, command.hold);
  has_started();
  console.print(
      (command.host.empty() ? "open in a browser on this machine: " : "open in a browser: ") +
      server->address());
  if (!command.host.empty())
    console.note("who has this address controls the run; what is sent is not encrypted");
  std::fflush(stdout);
  LiveObserver observer(console);
  run.run(observer);
  run.end();
  if (run.recording().has_inputs())
    console.print("repeat with: suture run " + run.recording().path().string());
  return 0;
}

}  // namespace suture
