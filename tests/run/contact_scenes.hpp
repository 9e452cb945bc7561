// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "kernel/forces/contact_law.hpp"
#include "kernel/run/simulation.hpp"
#include "kernel/scene/scene.hpp"
#include "tests/mesh/temporary_folder.hpp"

namespace suture::test {

Obstacle floor_at(double height, double friction);

/// A block of 0.4 x 0.4 x 0.2 m on a floor.
Scene block_on_floor(Index n, const Vec3& gravity, double friction, double young = 1e5);

/// Gravity on a slope of `part` of the angle of friction, in coordinates of the slope.
Vec3 on_slope(double friction, double part);

/// The speed at which a rigid block slides down that slope at last, with a mass-proportional
/// `damping`, m/s.
double sliding_speed(double friction, double part, double damping);

double mean_x(Simulation& simulation);

/// One static step to `end`, s.
void find_equilibrium(Scene& scene, double end);

/// Runs to the end; the text of the NumericalError that it throws, or "".
std::string error_of(Simulation& simulation);

/// Rows of 4.
std::vector<double> position_rows(Simulation& simulation);
/// Positions, the work of friction and that of contact after some steps of the dynamics.
std::vector<double> after_steps(Simulation& simulation, int steps, double dt);

/// Replaces the mesh by separate boxes, in a file of the folder.
void use_boxes(Scene& scene, const TemporaryFolder& folder, const std::vector<BoxOptions>& boxes);

/// A U that is pressed by 1.5 times its slot.
Scene bent_u(bool self);
/// The end of the upper arm of a U above that of the lower arm at the end of a run, m.
double slot_of(const Scene& scene);

/// A quarter of a block of 8 contact radii, into which a sphere of radius 1 m is pressed by 1 cm.
/// `n`: elements per contact radius.
Scene hertz(Index n);
/// The force over that of Hertz, at the end of a run.
double over_hertz(const Scene& scene);

}  // namespace suture::test
