// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <optional>

#include "apps/suture/commands.hpp"
#include "apps/suture/processes.hpp"
#include "apps/suture/signals.hpp"
#include "kernel/base/error.hpp"
#include "kernel/live/recording.hpp"
#include "kernel/output/checkpoint_file.hpp"
#include "kernel/output/output_folder.hpp"
#include "kernel/run/simulation.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture {
namespace {

std::string significant(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string describe(const Progress& progress) {
  if (progress.iteration > 0)
    return "solving step " + std::to_string(progress.step) +
           " to t = " + significant(progress.time) + " s: Newton iteration " +
           std::to_string(progress.iteration) + ", residual " + significant(progress.residual) +
           " of the forces (solved below " + significant(progress.tolerance) + ")";
  std::string text =
      "step " + std::to_string(progress.step) + ", t = " + significant(progress.time);
  if (progress.end > 0) {
    text += " of " + significant(progress.end) + " s";
    text += ", " + significant(100 * progress.time / progress.end) + " %";
  } else {
    text += " s, residual " + significant(progress.residual) + " (rest below " +
            significant(progress.tolerance) + ")";
  }
  text += ", " + short_number(progress.elements_per_second) + " elements/s";
  if (progress.seconds_left >= 0) text += ", " + duration(progress.seconds_left) + " left";
  return text;
}

/// Shows progress: on a terminal a few times a second, in a log every ten seconds.
class Watcher final : public Observer {
 public:
  /// `processes`: those that make the run together; null: this one alone. They ask each other for
  /// signals at every question, or at some if `steps_are_short`.
  Watcher(Console& console, Communicator* processes, bool steps_are_short)
      : console_(console), processes_(processes), steps_between_(steps_are_short ? 8 : 1) {}

  void on_progress(const Progress& progress) override {
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return;
    const bool first = next_ == std::chrono::steady_clock::time_point{};
    next_ =
        now + (console_.is_terminal() ? std::chrono::milliseconds(200) : std::chrono::seconds(10));
    // A log gets no line for a run that is over before the first interval is.
    if (!first || console_.is_terminal()) console_.status(describe(progress));
  }
  void on_message(const std::string& message) override { console_.note(message); }
  void on_detail(const std::string& message) override {
    if (console_.verbose()) console_.note(message);
  }
  bool stop_requested() override {
    if (is_at_end_) return true;
    if (!processes_ || questions_++ % steps_between_ == 0) look_for_signal();
    return signal_ != 0;
  }
  bool gives_up_step() override {
    look_for_signal();
    return signal_ != 0;
  }
  /// The one that stops the run, on whichever process it arrived; 0: none.
  int signal() const { return signal_; }
  /// Ends the run where it is.
  void end() { is_at_end_ = true; }

 private:
  /// One that was found stays.
  void look_for_signal() {
    if (signal_ != 0) return;
    signal_ = processes_ ? processes_->largest(caught_signal()) : caught_signal();
  }

  Console& console_;
  Communicator* processes_;
  unsigned steps_between_;
  unsigned questions_ = 0;
  int signal_ = 0;
  bool is_at_end_ = false;
  std::chrono::steady_clock::time_point next_{};
};

void print_summary(const RunSummary& summary, Console& console) {
  constexpr const char* outcomes[] = {"finished", "at rest", "interrupted",
                                      "in an unstable equilibrium"};
  std::string text = outcomes[static_cast<int>(summary.outcome)];
  text += " at t = " + significant(summary.time) + " s: " + count(summary.steps, "step") + " in " +
          duration(summary.seconds) + " (" + short_number(summary.elements_per_second) +
          " elements/s, " + count(summary.threads, "thread") + ")";
  if (summary.longest_dt > 0)
    text += ", dt from " + significant(summary.shortest_dt) + " to " +
            significant(summary.longest_dt) + " s, " + count(summary.rejected_steps, "step") +
            " rejected";
  if (summary.rollbacks > 0) text += ", " + count(summary.rollbacks, "rollback");
  if (summary.exchanged > 0)
    text += ", balance " + significant(100 * summary.balance / summary.exchanged) + " %";
  if (summary.frames > 0) text += ", " + count(summary.frames, "frame");
  if (summary.elements_cut > 0) text += ", " + count(summary.elements_cut, "element") + " cut";
  if (summary.faces_cut > 0) text += ", " + count(summary.faces_cut, "face") + " cut";
  if (summary.faces_torn > 0) text += ", " + count(summary.faces_torn, "face") + " torn";
  if (summary.faces_sewn > 0) text += ", " + count(summary.faces_sewn, "face") + " sewn";
  if (summary.elements_removed > 0)
    text += ", " + count(summary.elements_removed, "element") + " removed";
  if (summary.events_skipped > 0)
    text += ", " + count(summary.events_skipped, "event") + " skipped";
  if (summary.inverted_elements > 0) {
    text += ", " + count(summary.inverted_elements, "inverted element");
  }
  console.print(text);
  if (summary.debris.pieces > 0)
    console.print("debris removed: " + describe(summary.debris, summary.volume_at_start));
  if (!summary.pvd.empty()) console.print("open in ParaView: " + summary.pvd);
}

/// "tissue/edge springs, force: 1000 x 4000 cells, 45 ns per cell, 62 % of the run".
std::string describe(const FunctorCost& cost, double seconds) {
  const double per_call =
      static_cast<double>(cost.cells) / static_cast<double>(std::max<std::uint64_t>(1, cost.calls));
  std::string text = cost.functor + ", " + cost.function + ": " + std::to_string(cost.calls) +
                     " x " + significant(per_call) + " cells";
  if (cost.cells > 0)
    text +=
        ", " + significant(1e9 * cost.seconds / static_cast<double>(cost.cells)) + " ns per cell";
  return text + ", " + significant(100 * cost.seconds / seconds) + " % of the run";
}

void print_costs(std::vector<FunctorCost> costs, double seconds, Console& console) {
  std::ranges::sort(costs, std::greater(), &FunctorCost::seconds);
  for (const FunctorCost& cost : costs) console.print(describe(cost, seconds));
}

Scene scene_of(const Checkpoint& checkpoint, const RunCommand& command, PluginHost& host,
               Console& console) {
  const CheckpointHeader& header = checkpoint.header;
  SceneSource source{header.scene_text, header.scene_file, header.working_folder, {}};
  if (header.number > 0)
    source.resumed_folder = std::filesystem::absolute(command.resume).parent_path();
  else
    source.working_folder = std::filesystem::current_path();
  return read_scene_source(source, command.sets, host, console.diagnostics());
}

/// Reads the scene file, or the scene that the command repeats or resumes.
Scene scene_of(const RunCommand& command, const std::optional<Recording>& recording,
               PluginHost& host, Console& console) {
  if (is_checkpoint(command.scene))
    throw InputError(command.scene.string() + ": is a checkpoint; go on from it with --resume " +
                     command.scene.string());
  if (!recording) return read_scene(command.scene, command.sets, host, console.diagnostics());
  SceneSource source = recording->source;
  source.working_folder = std::filesystem::current_path();
  Scene scene = read_scene_source(source, command.sets, host, console.diagnostics());
  if (!recording->writes_results) scene.output.enabled = scene.checkpoint.enabled = false;
  return scene;
}

/// Whether the command says when a run ends.
bool gives_end(const RunCommand& command) {
  return std::ranges::any_of(
      command.sets, [](const std::string& set) { return set.starts_with("/solver/end="); });
}

/// Repeats a recording to its end; its last step is that of the run, unless the command gives an
/// end.
RunSummary run(Simulation& simulation, const std::optional<Recording>& recording,
               const Scene& scene, const RunCommand& command, Watcher& watcher, Console& console) {
  if (!recording || !repeat(*recording, scene, simulation, watcher, console.diagnostics()))
    return simulation.run(watcher);
  compare_end(*recording, simulation, console.diagnostics());
  if (gives_end(command)) return simulation.run(watcher);
  if (recording->end.empty() && recording->failure.empty())
    console.diagnostics().warn(
        "the recording has no end, as that of a program that was killed; it is repeated up to its "
        "last input. To go on from there, give --set /solver/end=SECONDS");
  watcher.end();
  RunSummary summary = simulation.run(watcher);
  summary.outcome = RunSummary::Outcome::finished;
  return summary;
}

void report_resume(const CheckpointHeader& header, Simulation& simulation, Console& console) {
  console.note("resuming from step " + std::to_string(header.step) +
               ", t = " + significant(header.time) + " s, of " + header.scene_file);
  if (header.isa != simulation.isa())
    console.diagnostics().warn("the earlier run used the instruction set " + header.isa +
                               ", this one uses " + std::string(simulation.isa()) +
                               ": results agree to within rounding, but not bit for bit");
}

OutputFolder::Writers writers_of(Communicator* processes) {
  if (!processes) return {};
  return {processes->size(), processes->rank(), [processes] { processes->largest(0); }};
}

void report_threads(unsigned wanted, unsigned used, Console& console) {
  if (used < wanted)
    console.note(std::to_string(used) + " of " + count(wanted, "thread") +
                 " used: more would be slower for a scene of this size");
}

}  // namespace

int run(const RunCommand& command, Console& console) {
  if (command.processes > 1 && !is_one_of_several())
    return run_by_processes(command.processes, console);
  catch_signals();
  Communicator* const processes = enter_processes(command.processes, console);
  PluginHost host(&console.diagnostics());
  std::optional<Recording> recording;
  if (command.resume.empty() && is_recording(command.scene))
    recording = read_recording(command.scene);
  const std::filesystem::path resumed = recording ? recording->checkpoint : command.resume;
  std::optional<Checkpoint> checkpoint;
  if (!resumed.empty()) checkpoint = read_checkpoint(resumed);
  Scene scene = checkpoint && !recording ? scene_of(*checkpoint, command, host, console)
                                         : scene_of(command, recording, host, console);
  const unsigned wanted_threads = scene.solver.threads;
  if (processes && wanted_threads == 0) scene.solver.threads = threads_of_each(*processes);
  // Before anything that takes time: another run may be writing there.
  const auto folder = std::make_shared<OutputFolder>(scene.output.directory, scene.output.root,
                                                     writers_of(processes));
  if (scene.output.enabled) {
    folder->open();
    has_opened(*folder);
    if (folder->was_unfinished())
      console.note(
          folder->path().string() +
          ": the last run that wrote here did not finish (it was killed, or a plugin ended "
          "it): its results are incomplete");
  }
  Simulation simulation(scene, host, console.diagnostics(), command.skip, folder,
                        command.check_plugins, processes);
  report_threads(wanted_threads, simulation.threads(), console);
  const std::uint64_t earlier_steps = checkpoint ? checkpoint->header.step : 0;
  if (checkpoint) {
    simulation.resume(*checkpoint, resumed);
    report_resume(checkpoint->header, simulation, console);
    checkpoint.reset();  // its memory
  }
  if (console.verbose()) {
    for (const Decision& decision : simulation.decisions()) {
      console.note((decision.skipped ? "skipped " : "") + decision.subject + ": " +
                   decision.reason);
    }
  }
  if (console.verbose()) simulation.measure();
  has_started();
  Watcher watcher(console, processes, !simulation.built().dynamics().is_implicit());
  const RunSummary summary = run(simulation, recording, scene, command, watcher, console);
  if (!console.quiet()) print_summary(summary, console);
  print_costs(simulation.costs(), summary.seconds, console);
  if (processes && console.verbose())
    console.print(describe_traffic(*processes, summary.steps - earlier_steps));
  if (summary.outcome == RunSummary::Outcome::unstable_equilibrium)
    return NumericalError("").exit_code();
  return summary.outcome == RunSummary::Outcome::interrupted ? 128 + watcher.signal() : 0;
}

}  // namespace suture
