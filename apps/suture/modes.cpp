// SPDX-License-Identifier: GPL-3.0-or-later
#include <chrono>
#include <cstdio>

#include "apps/suture/commands.hpp"
#include "apps/suture/signals.hpp"
#include "kernel/run/modal_run.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture {
namespace {

/// The messages of the static run, and the convergence with -v.
class Listener final : public Observer {
 public:
  explicit Listener(Console& console) : console_(console) {}
  void on_message(const std::string& message) override { console_.note(message); }
  void on_detail(const std::string& message) override {
    if (console_.verbose()) console_.note(message);
  }

 private:
  Console& console_;
};

std::string formatted(const char* format, double value) {
  char text[40];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string remark_of(const NaturalMode& mode) {
  switch (mode.kind) {
    case NaturalMode::Kind::zero:
      return "  zero: a rigid motion or a mechanism";
    case NaturalMode::Kind::unstable:
      return "  unstable: grows at " + formatted("%.6g", mode.growth()) + " 1/s";
    case NaturalMode::Kind::vibration:
      break;
  }
  return "";
}

std::string row_of(const NaturalMode& mode, std::size_t number) {
  const bool vibrates = mode.kind == NaturalMode::Kind::vibration;
  const bool is_zero = mode.kind == NaturalMode::Kind::zero;
  char text[80];
  std::snprintf(text, sizeof text, "%4zu  %14s  %15.9g  %8s", number,
                vibrates ? formatted("%.9g", mode.frequency()).c_str() : "-", mode.eigenvalue,
                is_zero ? "-" : formatted("%.1e", mode.residual).c_str());
  return text + remark_of(mode);
}

void print_table(const NaturalModes& modes, Console& console) {
  console.print("mode  frequency [Hz]  omega^2 [1/s^2]  residual");
  for (std::size_t i = 0; i < modes.modes.size(); ++i) console.print(row_of(modes.modes[i], i + 1));
}

}  // namespace

int modes(const ModesCommand& command, Console& console) {
  catch_signals();
  const auto start = std::chrono::steady_clock::now();
  PluginHost host(&console.diagnostics());
  Scene scene = read_scene(command.scene, command.sets, host, console.diagnostics());
  // Next to the results of a run, which stay.
  if (!command.names_folder) scene.output.directory /= "modes";
  const auto folder = std::make_shared<OutputFolder>(scene.output.directory, scene.output.root);
  if (scene.output.enabled) {
    folder->open();
    has_opened(*folder);
  }
  ModalRun run(scene, host, console.diagnostics(), {command.count, command.at_equilibrium});
  Listener listener(console);
  const NaturalModes found = run.solve(listener);
  has_started();  // from here on the files are finished, which takes little time
  std::string collection;
  if (scene.output.enabled) collection = run.write(found, folder);
  if (console.quiet()) return 0;
  print_table(found, console);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  console.print(count(found.modes.size(), "mode") + " of " + count(run.elements(), "element") +
                (command.at_equilibrium ? " at equilibrium" : " at rest") + " in " +
                duration(seconds.count()) + " (" + count(found.iterations, "iteration") + ", " +
                count(found.products, "product") + " with the tangent, " + found.preconditioner +
                ")");
  if (!collection.empty()) console.print("open in ParaView: " + collection);
  return 0;
}

}  // namespace suture
