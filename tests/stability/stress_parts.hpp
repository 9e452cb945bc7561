// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the trials of stresses.cpp are built from, and what they measure.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "kernel/run/simulation.hpp"
#include "tests/stability/draft.hpp"

namespace suture::test {

/// Ways to run a scene: four integrators, one equilibrium, several of them, and a search for rest.
const std::vector<std::string>& solver_names();

/// A model and a solver: what a stress acts on.
struct Pair {
  Material material;
  std::string solver;

  bool is_explicit() const { return solver == "symplectic-euler" || solver == "velocity-verlet"; }
  bool is_implicit() const { return solver == "implicit-euler" || solver == "newmark"; }
  bool moves() const { return is_explicit() || is_implicit(); }
  /// A step moves positions by the new velocities.
  bool is_euler() const { return solver == "symplectic-euler" || solver == "implicit-euler"; }
};

/// That of a trial, by its number.
Pair pair_of(const Draft& d);

Body box(const Vec3& size, const std::array<int, 3>& cells, double scale = 1);
Vec3 edges_of(const Body& body);

/// Begins the scene: `end` in periods; `dt` in periods, 0: as the program chooses it.
void begin(Draft& d, Pair pair, const Body& body, double end, double damping, double dt = 0);
void does_not_apply(Draft& d, const Pair& pair, const char* why);
/// The factor of a load that grows from 0 to 1 until then, s.
Json smooth(double to);

// Long enough to come to rest with a damping of 2 per period: exp(-24).
constexpr double damped = 2, settling = 24;

// ------------------------------------------------------------------ measures --

/// Displacement of a node over the sizes of the body.
Values strain_at(Simulation& simulation, const Vec3& node, const Vec3& size);
/// Positions of all vertices over a length.
Values shape_of(Simulation& simulation, double length);
double largest_displacement(Simulation& simulation);
/// Motion of the centre of mass from that of the body at rest, over a length.
Values drift_of(Simulation& simulation, const Vec3& size, double length);
Selection node_at(const Vec3& point);

}  // namespace suture::test
