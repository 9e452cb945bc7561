// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "apps/suture-bench/command_line.hpp"

namespace suture::bench {

/// Time per cut face, beside CGAL's unsew<3>.
void add_cut(CommandLine& line);
/// Time and memory per hexahedron of building the map from a mesh.
void add_build(CommandLine& line);
/// Blades of triangles, and moving ones.
void add_blade(CommandLine& line);
/// Rates of the models' forces through the SDK, by size, fresh and after cuts.
void add_force(CommandLine& line);
/// Products of the models' tangents in double and single precision beside their forces.
void add_tangent(CommandLine& line);
/// What looking for a tear costs beside the forces.
void add_events(CommandLine& line);
/// Whole runs with events beside runs without.
void add_event_costs(CommandLine& line);
void add_event_runs(CommandLine& line);
/// Where the time of a step goes.
void add_step(CommandLine& line);
/// Growing beams on one thread and on many (the paper's Fig. 8).
void add_scaling(CommandLine& line);

/// From a scene to its first step, and the memory that it holds.
void add_startup(CommandLine& line);

/// What each thing that is skipped would cost.
void add_skip(CommandLine& line);

/// Work to be counted by callgrind (tests/house/counted.sh), nothing measured.
void add_count(CommandLine& line);

/// What a frame costs the simulation.
void add_frame(CommandLine& line);

/// The largest block that moves in real time.
void add_realtime(CommandLine& line);

/// How fast a haptic device gets its force.
void add_haptic(CommandLine& line);
void add_live(CommandLine& line);

/// Time until the paper's cantilever is at rest.
void add_rest(CommandLine& line);

/// Linear solvers: set-up, iterations and time.
void add_solve(CommandLine& line);
/// Static equilibria: time, iterations and error.
void add_static(CommandLine& line);
/// Implicit steps: time and iterations.
void add_implicit(CommandLine& line);
/// Equilibria at frame rate, with cuts.
void add_quasi_static(CommandLine& line);
/// Natural modes: time, iterations and residuals.
void add_modes(CommandLine& line);

/// Near pairs, and what contact adds to a step.
void add_contact(CommandLine& line);

/// The bodies that are cut, written as surfaces.
void add_bodies(CommandLine& line);

}  // namespace suture::bench
