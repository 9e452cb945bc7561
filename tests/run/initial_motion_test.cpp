// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bodies that move at the start: free flight, spin, what constraints hold, and resumed runs.
#include <gtest/gtest.h>

#include <cmath>

#include "kernel/base/vec3.hpp"
#include "kernel/scene/scene_reader.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test::initial_motion_test {
namespace {

/// A block of 3 x 1 x 2 m far from the origin.
Scene scene_of(const TemporaryFolder& folder, const std::string& motion, const std::string& solver,
               const std::string& constraints = "[]") {
  const auto file = folder.write("s.json", R"({"suture": 2,
    "mesh": {"box": {"size": [3, 1, 2], "cells": [3, 1, 2], "origin": [1000, -200, 50]}},
    "models": [{"model": "neo-hookean", "parameters": {"E": 1e6, "nu": 0.3, "rho": 10}}],
    "constraints": )" + constraints + R"(, "initial_motion": )" +
                                               motion + R"(, "solver": )" + solver +
                                               R"(, "output": false})");
  Diagnostics diagnostics;
  return read_scene(file, {}, host(), diagnostics);
}

struct Momenta {
  double mass = 0, kinetic = 0;
  Vec3 linear{}, angular{}, centre{};  ///< angular: about the centre of mass
};
Vec3 row(const Column& column, Index v) {
  return {column.get(v, 0), column.get(v, 1), column.get(v, 2)};
}
Momenta momenta_of(Simulation& simulation) {
  Momenta sum;
  Attributes& a = simulation.attributes();
  const Column &x = a.position(), &velocity = a.velocity();
  for (Index v = 0; v < x.size(); ++v) {
    const double m = a.mass().get(v, 0);
    sum.mass += m;
    sum.kinetic += m / 2 * dot(row(velocity, v), row(velocity, v));
    for (std::size_t c = 0; c < 3; ++c) {
      sum.linear[c] += m * row(velocity, v)[c];
      sum.centre[c] += m * row(x, v)[c];
    }
  }
  for (double& c : sum.centre) c /= sum.mass;
  for (Index v = 0; v < x.size(); ++v) {
    const Vec3 turned = cross(minus(row(x, v), sum.centre), row(velocity, v));
    for (std::size_t c = 0; c < 3; ++c) sum.angular[c] += a.mass().get(v, 0) * turned[c];
  }
  return sum;
}

/// Moment of inertia of the masses about the axis y through their centre.
double inertia_about_y(Simulation& simulation) {
  const Momenta sum = momenta_of(simulation);
  Attributes& a = simulation.attributes();
  double inertia = 0;
  for (Index v = 0; v < a.rest().size(); ++v) {
    const Vec3 r = minus(row(a.rest(), v), sum.centre);
    inertia += a.mass().get(v, 0) * (r[0] * r[0] + r[2] * r[2]);
  }
  return inertia;
}

constexpr const char* solvers[] = {R"({"integrator": "symplectic-euler", "end": 0.02})",
                                   R"({"integrator": "velocity-verlet", "end": 0.02})",
                                   R"({"integrator": "implicit-euler", "dt": 1e-3, "end": 0.02})",
                                   R"({"integrator": "newmark", "dt": 1e-3, "end": 0.02})",
                                   R"({"integrator": "xpbd", "dt": 1e-4, "end": 0.02})"};

TEST(InitialMotion, FliesFreelyWithItsMomentumWhateverTheIntegrator) {
  for (const char* solver : solvers) {
    SCOPED_TRACE(solver);
    const TemporaryFolder folder;
    TestSimulation simulation(
        scene_of(folder, R"([{"where": "all", "velocity": [3, -1, 2]}])", solver));
    const Momenta before = momenta_of(simulation);
    EXPECT_NEAR(before.mass, 60, 1e-9);
    EXPECT_NEAR(before.kinetic, 30 * (9 + 1 + 4), 1e-9);
    simulation.run();
    const Momenta after = momenta_of(simulation);
    for (std::size_t c = 0; c < 3; ++c) {
      const double speed = std::array{3., -1., 2.}[c];
      EXPECT_NEAR(after.linear[c], 60 * speed, 1e-9);
      EXPECT_NEAR(after.centre[c] - before.centre[c], 0.02 * speed, 1e-9);
    }
  }
}

TEST(InitialMotion, SpinsAboutItsCentreOfMass) {
  for (const char* solver : solvers) {
    SCOPED_TRACE(solver);
    const TemporaryFolder folder;
    TestSimulation simulation(scene_of(folder, R"([{"where": "all", "spin": [0, 4, 0]}])", solver));
    const double inertia = inertia_about_y(simulation);
    const Momenta before = momenta_of(simulation);
    EXPECT_NEAR(before.kinetic, inertia * 16 / 2, 1e-9 * inertia);
    EXPECT_NEAR(before.angular[1], 4 * inertia, 1e-9 * inertia);
    for (const double p : before.linear) EXPECT_NEAR(p, 0, 1e-9);
    simulation.run();
    EXPECT_NEAR(momenta_of(simulation).angular[1], 4 * inertia, 2e-3 * inertia);
  }
}

TEST(InitialMotion, ACentreThatIsGivenRestsAndEntriesAddUp) {
  const TemporaryFolder folder;
  TestSimulation simulation(scene_of(folder, R"([
      {"where": "all", "velocity": [1, 0, 0]},
      {"where": {"set": "x1"}, "spin": [0, 0, 2], "centre": [1003, -200, 50]}])",
                                     solvers[0]));
  Attributes& a = simulation.attributes();
  for (Index v = 0; v < a.rest().size(); ++v) {
    const Vec3 X = row(a.rest(), v), velocity = row(a.velocity(), v);
    const bool is_end = X[0] > 2.9;  // from the corner of the body
    EXPECT_NEAR(velocity[0], is_end ? 1 - 2 * X[1] : 1, 1e-9);
    EXPECT_NEAR(velocity[1], 0, 1e-9);
    EXPECT_NEAR(velocity[2], 0, 1e-9);
  }
}

TEST(InitialMotion, WhatAConstraintHoldsKeepsTheVelocityOfTheConstraint) {
  const TemporaryFolder folder;
  TestSimulation simulation(scene_of(folder, R"([{"where": "all", "velocity": [1, 2, 3]}])",
                                     solvers[0], R"([{"fix": "xz", "where": {"set": "x0"}}])"));
  Attributes& a = simulation.attributes();
  for (Index v = 0; v < a.rest().size(); ++v) {
    const bool is_held = row(a.rest(), v)[0] < 0.1;
    EXPECT_EQ(row(a.velocity(), v), is_held ? (Vec3{0, 2, 0}) : (Vec3{1, 2, 3}));
  }
}

}  // namespace
}  // namespace suture::test::initial_motion_test
