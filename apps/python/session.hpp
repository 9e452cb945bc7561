// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "apps/python/callbacks.hpp"
#include "apps/python/read_mesh.hpp"
#include "apps/python/views.hpp"
#include "kernel/base/archive.hpp"
#include "kernel/gradients/followed_slopes.hpp"
#include "kernel/gradients/kept_steps.hpp"
#include "kernel/live/live_run.hpp"
#include "kernel/results/probe_table.hpp"
#include "kernel/run/simulation.hpp"

namespace suture::python {

class PythonTerm;

/// How a scene becomes a run.
struct SessionOptions {
  std::string text;            ///< of the scene, or
  std::filesystem::path file;  ///< of the scene; for a text, its name in messages
  bool is_text = false;
  std::vector<std::string> sets;     ///< as --set
  std::shared_ptr<const Mesh> mesh;  ///< that the scene does not contain; may be null
  std::shared_ptr<ReadMesh> read;    ///< that the scene need not read; may be null
  bool output = false;               ///< write what /output asks for
  std::filesystem::path folder{};    ///< where, if not to /output/directory
};

/// The state of a run, in memory: what a checkpoint of it would contain.
struct SessionState {
  std::string scene_hash, mesh_hash;  ///< of the scene and its mesh, as they were built
  std::vector<std::string> terms;     ///< names of the force functions
  std::optional<std::string> outcome;
  double time = 0;  ///< s
  std::uint64_t steps = 0;
  StateTree state;
};

/// A simulation that Python holds, with everything it refers to. All functions are called with the
/// GIL held; those that take time release it.
///
/// A session is used by one thread at a time and in the process that made it: other uses raise
/// RuntimeError. An error of the run ends it: its columns can still be read.
class Session {
 public:
  explicit Session(const SessionOptions& options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // ---- steps ----

  std::uint64_t step(std::uint64_t count);
  void run_to(double time);
  /// Runs to the end; `progress` is called a few times a second with step, time and end.
  RunSummary run(py::object progress);
  double time() const { return run_.simulation->time(); }
  std::uint64_t steps() const { return run_.simulation->step(); }
  double dt();
  /// How the run ended: "finished", "at rest", ...; none while it has not.
  std::optional<std::string> outcome() const { return outcome_; }
  const std::vector<std::string>& messages();

  // ---- between steps, and in callbacks ----

  /// Applies the event of a JSON text, whose name in messages is `name`.
  EventOutcome apply(const std::string& text, const std::string& name);
  EventOutcome cut(TriangleSurface surface, bool rest_shape, std::optional<bool> along_blade);
  void set_position(const py::array& values);
  void set_velocity(const py::array& values);
  /// Simulation::steer().
  void steer(const std::string& obstacle, const PoseTarget& target);
  /// Simulation::move_grasp(), to be there at this time, s.
  void move_grasp(const std::string& name, const Vec3& translation, double at);
  /// Simulation::set_parameters(), of a model by its number; `text` is JSON: {"E": 2e4}.
  void set_parameters(std::size_t model, const std::string& text);
  /// Simulation::set_field(), of a model by its number.
  void set_field(std::size_t model, const std::string& parameter, const py::array& values);
  void set_gravity(const Vec3& value);
  /// Simulation::equilibrate().
  void equilibrate();
  /// Keeps the steps from now on, for their derivatives; those before are forgotten.
  void keep_steps(const StepReplay::Limit& limit);
  /// None if no steps are kept.
  KeptSteps* kept_steps() { return run_.kept_steps.get(); }
  /// Follows the derivatives by these parameters from now on.
  void follow(std::vector<ParameterDirection> parameters, double tolerance);
  /// None if nothing is followed.
  FollowedSlopes* followed() { return run_.followed.get(); }
  std::shared_ptr<SessionState> copy();
  /// Saves a checkpoint from which `suture run --resume` and `suture live` go on.
  void save_checkpoint(const std::filesystem::path& file);
  /// Builds the run again and loads the state. If that fails, nothing has changed.
  void restore(const SessionState& state);
  // ---- live view: live.cpp ----

  /// Serves a view of the run (kernel/live); returns its address. `recording`: the file, "" for a
  /// name of its own, none for no file. All that was done before is part of it.
  std::string open_live(unsigned port, const std::string& host,
                        std::optional<std::filesystem::path> recording);
  /// Gives the control to the page for so long, s, or until Ctrl-C.
  void run_live(double seconds);
  /// The recording of the view; none before its first input, or if there is none.
  std::optional<std::filesystem::path> live_recording() const;
  void close_live();

  PythonTerm& add_term(std::unique_ptr<PythonTerm> term);
  Callbacks& callbacks() { return observer_.callbacks; }
  /// The simulation for reading; raises if another thread is running it.
  Simulation& simulation();
  /// The same, where no step is in progress: raises in a force function.
  Simulation& between_steps();
  /// Raises InputError if the scene has no probes.
  ProbeTable& probes();
  Views& views() { return *run_.views; }
  const Scene& scene() const { return scene_; }

  int traverse(visitproc visit, void* argument);
  void clear();

 private:
  class Running;
  /// What refers to a simulation ends before it.
  struct Run {
    std::unique_ptr<Simulation> simulation;
    std::unique_ptr<ProbeTable> probes;
    std::unique_ptr<KeptSteps> kept_steps;
    std::unique_ptr<FollowedSlopes> followed;
    std::unique_ptr<Views> views;
    std::vector<PythonTerm*> terms;
  };
  /// An input that was applied to the run before `step`.
  void record(std::uint64_t step, std::string value);
  /// What no recording can repeat was done.
  void forgo_recording(const std::string& why);
  Run build(std::shared_ptr<OutputFolder> folder);
  std::vector<std::string> term_names() const;
  void require_no_output(const char* what) const;
  void require_fit(const SessionState& state) const;
  void require_steps();
  template <class F>
  void advance(F&& f);
  void pause_at(const Pause& pause);
  EventOutcome apply(const Event& event);
  void require_own_process() const;
  void require_alive() const;
  void warn_of_new();

  unsigned forks_;  ///< of the process, when it was made
  Diagnostics diagnostics_;
  PluginHost host_{&diagnostics_};
  Scene scene_;
  Run run_;
  CheckpointHeader header_;
  Observing observer_{*this};
  std::size_t warned_ = 0;
  std::optional<std::string> outcome_, failure_;
  bool is_given_mesh_;               ///< not part of the scene
  std::vector<RecordedInput> done_;  ///< by the script
  std::string not_recorded_;         ///< why nothing can be recorded any more; "" if it can
  std::unique_ptr<LiveServer> live_server_;
  std::unique_ptr<LiveRun> live_;
  std::optional<std::thread::id> runner_;
};

}  // namespace suture::python
