// SPDX-License-Identifier: GPL-3.0-or-later
//
// Faces of which only some components are moved: tests of materials with their closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "kernel/scene/scene_reader.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/csv_table.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test::components_test {
namespace {

constexpr double E = 1e4, nu = 0.45, mu = E / 2 / (1 + nu),
                 lambda = E * nu / (1 + nu) / (1 - 2 * nu);

const std::string symmetric = R"({"fix": "x", "where": {"set": "x0"}},
    {"fix": "y", "where": {"set": "y0"}}, {"fix": "z", "where": {"set": "z0"}})";

/// Runs a cube of 2 x 2 x 2 neo-Hookean elements of 1 m with a probe on each of the faces x1 and
/// y1; returns the table of the probes.
CsvTable probes_of(const std::string& constraints, const std::string& solver,
                   const std::string& events = "[]") {
  const TemporaryFolder folder;
  const auto file = folder.write("s.json", R"({"suture": 2,
    "mesh": {"box": {"size": [1, 1, 1], "cells": [2, 2, 2]}},
    "models": [{"model": "neo-hookean", "parameters": {"E": 1e4, "nu": 0.45, "rho": 1}}],
    "constraints": [)" + constraints +
                                               R"(],
    "solver": )" + solver + R"(, "events": )" + events +
                                               R"(,
    "output": {"frames": false, "probes": {"at": [
      {"name": "x", "fields": ["displacement", "reaction"], "where": {"set": "x1"}},
      {"name": "y", "fields": ["displacement"], "where": {"set": "y1"}}]}}})");
  Diagnostics diagnostics;
  Scene scene = read_scene(file, {}, host(), diagnostics);
  scene.output.directory = folder.path() / "out";
  TestSimulation simulation(scene);
  simulation.run();
  return CsvTable(folder.path() / "out" / "probes.csv");
}

/// The force on a bar of 1 m^2 that is drawn to the stretch l and free across, W = mu/2 (F:F - 3) -
/// mu ln J + lambda/2 (ln J)^2: its stretch a across follows from
///   mu (a - 1/a) + lambda ln(l a^2) / a = 0,   force = mu (l - 1/l) + lambda ln(l a^2) / l
double stretch_across(double l) {
  double low = 0.3, high = 1.5;
  for (int i = 0; i < 200; ++i) {
    const double a = (low + high) / 2;
    (mu * (a - 1 / a) + lambda * std::log(l * a * a) / a < 0 ? low : high) = a;
  }
  return low;
}
double pull(double l) {
  const double a = stretch_across(l);
  return mu * (l - 1 / l) + lambda * std::log(l * a * a) / l;
}

void expect_uniaxial(const CsvTable& probes, double l, double tolerance) {
  EXPECT_NEAR(probes.last("x displacement x [m]"), l - 1, 1e-12);
  EXPECT_NEAR(probes.last("y displacement y [m]"), stretch_across(l) - 1, tolerance);
  EXPECT_NEAR(probes.last("x reaction x [N]"), pull(l), tolerance * E);
  EXPECT_NEAR(probes.last("x reaction y [N]"), 0, tolerance * E);
}

const std::string pulled = R"("move": {"translation": [0.5, 0, 0]}, "components": "x", "ramp": 1,
                              "where": {"set": "x1"})";

TEST(MovedComponents, UniaxialTensionHasItsClosedForm) {
  expect_uniaxial(
      probes_of(symmetric + ", {" + pulled + "}", R"({"static": {"frames": 4}, "end": 1})"), 1.5,
      1e-8);
}

TEST(MovedComponents, AGraspPullsAsAConstraintDoes) {
  const std::string grasp = R"([{"at": 0, "grasp": {"name": "clamp", )" + pulled + "}}]";
  expect_uniaxial(probes_of(symmetric, R"({"static": {"frames": 4}, "end": 1})", grasp), 1.5, 1e-8);
}

// Pulled slowly, light, and damped.
TEST(MovedComponents, StepsOfAMotionArriveAtTheEquilibrium) {
  for (const char* solver :
       {R"({"integrator": "implicit-euler", "dt": 0.02, "end": 2, "damping": 20})",
        R"({"integrator": "symplectic-euler", "end": 2, "damping": 20})"}) {
    SCOPED_TRACE(solver);
    expect_uniaxial(probes_of(symmetric + ", {" + pulled + "}", solver), 1.5, 1e-4);
  }
}

// Two components of equal stretch l: mu (a - 1/a) + lambda ln(l^2 a) / a = 0.
TEST(MovedComponents, EquibiaxialTensionHasItsClosedForm) {
  const double l = 1.25;
  double low = 0.3, high = 1.5;
  for (int i = 0; i < 200; ++i) {
    const double a = (low + high) / 2;
    (mu * (a - 1 / a) + lambda * std::log(l * l * a) / a < 0 ? low : high) = a;
  }
  const CsvTable probes = probes_of(
      symmetric +
          R"(, {"move": {"translation": [0.25, 0, 0]}, "components": "x", "ramp": 1, "where": {"set": "x1"}},
         {"move": {"translation": [0, 0.25, 0]}, "components": "y", "ramp": 1, "where": {"set": "y1"}})",
      R"({"static": {"frames": 4}, "end": 1})");
  EXPECT_NEAR(probes.last("x reaction x [N]"),
              mu * (l - 1 / l) + lambda * std::log(l * l * low) / l, 1e-8 * E);
}

// Twisted about x, a bar of this law grows longer if it is free to (Poynting); held, it pushes.
TEST(MovedComponents, ATwistLeavesTheAxisFree) {
  const auto twist = [](const std::string& components) {
    return R"({"fix": "xyz", "where": {"set": "x0"}}, {"move": {"rotation": {"axis": [1, 0, 0], "angle": 30}}, "components": ")" +
           components + R"(", "ramp": 1, "where": {"set": "x1"}})";
  };
  const std::string solver = R"({"static": {"frames": 4}, "end": 1})";
  const CsvTable held = probes_of(twist("xyz"), solver), free = probes_of(twist("yz"), solver);
  EXPECT_GT(std::abs(held.last("x reaction x [N]")), 1e-3 * E);
  EXPECT_NEAR(free.last("x reaction x [N]"), 0, 1e-8 * E);
  EXPECT_GT(std::abs(free.last("x displacement x [m]")), 1e-3);
}

}  // namespace
}  // namespace suture::test::components_test
