// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/base/diagnostics.hpp"
#include "kernel/dynamics/dynamics.hpp"
#include "kernel/operations/event_runner.hpp"
#include "kernel/plugin_host/plugin_host.hpp"
#include "kernel/run/run_report.hpp"
#include "kernel/scene/scene.hpp"
#include "kernel/steps/failed_piece.hpp"

namespace suture {

class Communicator;
class OutputFolder;
class ContactLaw;
class RunLoop;
struct Checkpoint;

/// A scene compiled into a run, which keeps a copy of the scene. The constructor does everything
/// that can fail because of the scene or the mesh (nothing is written before it returns), and
/// throws one InputError for all selections that are wrong, with their places in the file; run()
/// does the rest.
class Simulation {
 public:
  /// `skip`: leave out what the scene does not need (decisions() says what); false computes it
  /// anyway, with the same results (suture run --no-skip).
  /// `folder`: the output folder, if the caller has opened it already; nullptr: run() opens it.
  /// `check_plugins`: checks every call of a plugin's force (ForceLoop::check_plugins), and the
  /// bounds of the stable step once.
  /// `processes`: make the run together: each builds the same body, computes a part of its forces
  /// and energies, and gives the rest of the results as one process does, bit for bit. Throws
  /// InputError if they differ, or naming what of the scene they cannot share. They must outlive
  /// the run.
  Simulation(const Scene& scene, PluginHost& host, Diagnostics& diagnostics, bool skip = true,
             std::shared_ptr<OutputFolder> folder = nullptr, bool check_plugins = false,
             Communicator* processes = nullptr);
  ~Simulation();

  /// Resumes from a checkpoint of a run of this scene, read from `file`; call before anything else.
  /// Throws InputError with the reason if that is not possible.
  void resume(const Checkpoint& checkpoint, const std::filesystem::path& file);

  /// Runs to the end, writes frames and tables. Throws NumericalError (frames written earlier
  /// remain; no frame shows an invalid state) and IoError. If interrupted, finishes the step,
  /// or gives it up if it solves equations (Observer::gives_up_step), writes a frame and returns.
  RunSummary run(Observer& observer);
  /// The same up to a pause, for programs that inspect the state in between; run() or the next call
  /// continues from there. Inspecting changes no bit of later results. Returns how the run ended or
  /// that it was interrupted, or none if it pauses; call run() at the end, which finishes the
  /// tables. An Error ends the run as in run(). Any other exception, thrown by a term that was
  /// added, leaves the run as it was before the step.
  std::optional<RunSummary::Outcome> advance(const Pause& pause, Observer& observer);
  void run_to(double time, Observer& observer) { advance({time, {}}, observer); }
  double time() const;         ///< s
  std::uint64_t step() const;  ///< number of steps made
  double next_dt();            ///< s: the length of the next step

  // ---- between two calls of advance(), or from the observer ----

  /// Applies an operation now; it is reported like an event of the scene (its times are ignored).
  /// Throws the same errors as events; nothing has changed then.
  EventOutcome apply(const Event& event, Observer& observer);
  /// Moves vertices or changes their velocities, in `change`; the change of the energy is booked as
  /// that of an event. Constrained vertices return to their prescribed positions. If a value is not
  /// finite, throws InputError naming its node; nothing has changed then.
  void change_motion(const std::function<void(Attributes&)>& change);
  /// Moves an obstacle, or the hand of a compliant tool, from where it is now to the target, where
  /// it stays: at a constant velocity and spin. This replaces the rest of its path, or of an
  /// earlier call. An automatic dt follows it; a blade that the obstacle carries moves along.
  /// Throws InputError if there is no such obstacle, if the target is not finite or not in the
  /// future, or if the motion is too fast for a fixed dt; nothing has changed then. O(boundary)
  /// while islands sleep or if a half-space turns, else O(1).
  void steer(const std::string& obstacle, const PoseTarget& target);
  /// Moves what a grasp holds from where it is now by a translation (m), at a constant velocity for
  /// so long (s), and holds it there. Throws InputError if there is no such grasp, or if a number
  /// is not finite or the duration not positive; nothing has changed then.
  void move_grasp(const std::string& grasp, const Vec3& translation, double duration);
  /// With what the body pulls at what holds a grasp, N: the forces on its nodes, without those of
  /// contact; zero if there is no such grasp. Changes no bit of later steps, and costs the forces
  /// of the next one, which does not compute them again.
  Vec3 force_on_grasp(const std::string& grasp);
  /// Adds a term, whose forces act from now on. Throws InputError if this run cannot take it.
  ForceTerm& add_term(std::unique_ptr<ForceTerm> term);

  /// Changes the parameters of a model of the scene (read_parameters()), and all that follows from
  /// them: masses, forces, the stable step, preconditioners. Positions and velocities stay; the
  /// change of the energy is booked as that of an event. Throws InputError if the model refuses
  /// them, or if they need what was not built, and the errors of forces; nothing has changed then.
  /// O(elements), and a search of the stable step.
  void set_parameters(Instance& instance, std::vector<double> values);
  /// The same with one parameter that may differ from element to element (its place in the model):
  /// one value per row of instance.table(3).
  void set_field(Instance& instance, std::size_t parameter, std::vector<double> values);
  /// Changes gravity, m/s^2, in the same way; its ramp goes on.
  void set_gravity(const Vec3& value);

  /// Finds the equilibrium again from the current positions, at the same time, in a static run that
  /// has made a step: after loads, parameters or cells were changed. Throws InputError for another
  /// run, and NumericalError if there is no equilibrium within reach.
  void equilibrate(Observer& observer);

  /// Everything that a run changes, as a checkpoint stores it. `spare`: save_state().
  StateTree save(StateTree* spare = nullptr);
  /// Continues from the state of another simulation of the same scene; call before anything but
  /// add_term(): the terms are those of the state. Throws InputError if it does not fit.
  void load(const StateTree& state);

  Energies energies();  ///< J; potentials are zero at rest positions
  /// The part of the energy exchanged so far that nothing explains, at the last check of the run;
  /// 0 for a static run.
  double balance() const;

  /// The body, its dynamics and the user's names for its cells.
  BuiltScene& built();
  const CellComplex& complex() const;
  Attributes& attributes();
  /// The obstacles and the forces on them in the last step; null without obstacles.
  const ContactLaw* contact() const;
  /// The blades that are present now (EventRunner::blades()), in the frame of the body.
  std::vector<BladeShape> blades() const;
  /// The body's own origin in the scene, m. Positions in attributes() are relative to it; events
  /// and selections passed by a caller use coordinates of the scene.
  Vec3 origin() const;
  /// The mean displacement of the selected vertices, m.
  Vec3 mean_displacement(const Selection& selection) const;

  /// Where the run has failed, if it did so at a small piece.
  const std::optional<FailedPiece>& failed_piece() const;

  /// Times the functions of functors from now on; costs() says what they took.
  void measure();
  std::vector<FunctorCost> costs() const;
  /// Computes forces and energies of the current state, only to check them.
  void try_plugins();

  const std::vector<Decision>& decisions() const;
  unsigned threads() const;      ///< that are used; at most as many as the scene requests
  std::string_view isa() const;  ///< of the loops: "avx512", "avx2" or "base"
  /// Times a few steps; the simulation cannot be used afterwards.
  Estimate estimate();

 private:
  std::unique_ptr<RunLoop> run_;
};

}  // namespace suture
