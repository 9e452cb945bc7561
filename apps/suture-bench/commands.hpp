// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "apps/suture-bench/report.hpp"

namespace CLI {
class App;
}

namespace suture::bench {

struct Command {
  CLI::App* app;
  std::function<void(Report&)> run;
  bool measures = true;  ///< false: not among those that run without a subcommand
};

/// Time per cut face, beside CGAL's unsew<3>.
void add_cut(CLI::App& app, std::vector<Command>& commands);
/// Time and memory per hexahedron of building the map from a mesh.
void add_build(CLI::App& app, std::vector<Command>& commands);
/// Blades of triangles, and moving ones.
void add_blade(CLI::App& app, std::vector<Command>& commands);
/// Rates of the models' forces through the SDK, by size, fresh and after cuts.
void add_force(CLI::App& app, std::vector<Command>& commands);
/// Products of the models' tangents in double and single precision beside their forces.
void add_tangent(CLI::App& app, std::vector<Command>& commands);
/// What looking for a tear costs beside the forces.
void add_events(CLI::App& app, std::vector<Command>& commands);
/// Whole runs with events beside runs without.
void add_event_runs(CLI::App& app, std::vector<Command>& commands);
/// Where the time of a step goes.
void add_step(CLI::App& app, std::vector<Command>& commands);
/// Growing beams on one thread and on many (the paper's Fig. 8).
void add_scaling(CLI::App& app, std::vector<Command>& commands);

/// From a scene to its first step, and the memory that it holds.
void add_startup(CLI::App& app, std::vector<Command>& commands);

/// What each thing that is skipped would cost.
void add_skip(CLI::App& app, std::vector<Command>& commands);

/// Work to be counted by callgrind (tests/house/counted.sh), nothing measured.
void add_count(CLI::App& app, std::vector<Command>& commands);

/// What a frame costs the simulation.
void add_frame(CLI::App& app, std::vector<Command>& commands);

/// The largest block that moves in real time.
void add_realtime(CLI::App& app, std::vector<Command>& commands);

/// How fast a haptic device gets its force.
void add_haptic(CLI::App& app, std::vector<Command>& commands);

/// Time until the paper's cantilever is at rest.
void add_rest(CLI::App& app, std::vector<Command>& commands);

/// Linear solvers: set-up, iterations and time.
void add_solve(CLI::App& app, std::vector<Command>& commands);
/// Static equilibria: time, iterations and error.
void add_static(CLI::App& app, std::vector<Command>& commands);
/// Implicit steps: time and iterations.
void add_implicit(CLI::App& app, std::vector<Command>& commands);
/// Equilibria at frame rate, with cuts.
void add_quasi_static(CLI::App& app, std::vector<Command>& commands);
/// Natural modes: time, iterations and residuals.
void add_modes(CLI::App& app, std::vector<Command>& commands);

/// Near pairs, and what contact adds to a step.
void add_contact(CLI::App& app, std::vector<Command>& commands);

/// Error against run time of whole processes.
void add_work_precision(CLI::App& app, std::vector<Command>& commands);

/// The paper's experiments beside formulas, laws and references.
void add_paper(CLI::App& app, std::vector<Command>& commands);

/// The bodies that are cut, written as surfaces.
void add_bodies(CLI::App& app, std::vector<Command>& commands);

}  // namespace suture::bench
