// SPDX-License-Identifier: GPL-3.0-or-later
//
// Foundations: closed forms, derivatives, the ledger, cuts and sewing, bodies from a surface.
#include "kernel/forces/foundations.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "kernel/base/vec3.hpp"
#include "kernel/run/inventory.hpp"
#include "kernel/scene/scene_reader.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test::foundations_test {
namespace {

constexpr const char* cube = R"("mesh": {"box": {"size": [1, 1, 1], "cells": [3, 3, 3]}})";
constexpr const char* rubber =
    R"("models": [{"model": "neo-hookean", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}])";
constexpr const char* cork =
    R"("models": [{"model": "hooke", "parameters": {"E": 1e6, "nu": 0, "rho": 1000}}])";

/// A scene of version 2 without output.
Scene scene_of(const std::string& mesh, const std::string& models, const std::string& more) {
  Diagnostics diagnostics;
  return read_scene_text(
      R"({"suture": 2, "output": false, )" + mesh + ", " + models + ", " + more + "}", "s.json", {},
      lookup_of(host()), diagnostics);
}

Foundations& foundations_of(Simulation& simulation) {
  for (const auto& term : simulation.built().body().terms())
    if (auto* found = dynamic_cast<Foundations*>(term.get())) return *found;
  throw std::logic_error("no foundation");
}

Vec3 row(const Column& column, Index v) {
  return {column.get(v, 0), column.get(v, 1), column.get(v, 2)};
}

/// The sum of the forces of the foundations after a translation of the whole body.
Vec3 force_after(Simulation& simulation, const Vec3& translation) {
  Attributes& attributes = simulation.attributes();
  const CellComplex& complex = simulation.built().body().complex();
  std::vector<double> rows(4 * std::size_t{attributes.vertex_count()});
  double* x = attributes.position().rows();
  const auto translate = [&](double way) {
    for (Index v = 0; v < attributes.vertex_count(); ++v)
      for (std::size_t c = 0; c < 3; ++c) x[4 * std::size_t{v} + c] += way * translation[c];
  };
  translate(1);
  foundations_of(simulation).add_forces(0, {}, rows.data());
  translate(-1);
  Vec3 sum{};
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_TRUE(complex.exists(0, v) || rows[4 * std::size_t{v} + c] == 0);
      sum[c] += rows[4 * std::size_t{v} + c];
    }
  return sum;
}

// A column of height L under a pressure p: u(z) = - p / k_n - p z / E, for nu = 0.
TEST(Foundations, ABlockSinksByThePressureOverTheStiffness) {
  for (const char* events : {"[]", R"([{"at": 0.3, "cut": {"plane": {"point": [0.37, 0, 0],
       "normal": [1, 0.2, 0]}}}, {"at": 0.6, "cut": {"faces": [[1, 2]], "along": "faces"}}])"}) {
    TestSimulation simulation(scene_of(cube, cork,
                                       R"("foundations": [
        {"where": {"set": "z0"}, "normal": 2e5, "tangential": 10}],
        "loads": [{"traction": [0, 0, -1000], "where": {"set": "z1"}}],
        "solver": {"static": {"frames": 10, "tolerance": 1e-12}, "end": 1}, "events": )" +
                                           std::string(events)));
    simulation.run();
    Attributes& a = simulation.attributes();
    for (Index v = 0; v < a.vertex_count(); ++v)
      if (simulation.built().body().complex().exists(0, v)) {
        EXPECT_NEAR(a.position().get(v, 2) - a.rest().get(v, 2),
                    -1000 / 2e5 - 1000 * a.rest().get(v, 2) / 1e6, 1e-9)
            << events;
      }
  }
}

// omega^2 = k_n A / M, and k_t A / M across, for a body that is far stiffer.
TEST(Foundations, ABodySwingsAtTheRootOfStiffnessOverMass) {
  for (const std::size_t axis : {std::size_t{2}, std::size_t{0}}) {
    Vec3 velocity{};
    velocity[axis] = 1;
    std::ostringstream motion;
    motion << velocity[0] << ", " << velocity[1] << ", " << velocity[2];
    const double omega = std::sqrt((axis == 2 ? 2e5 + 2e5 : 5e4 + 5e4) / 1000);
    TestSimulation simulation(scene_of(
        R"("mesh": {"box": {"size": [1, 1, 1], "cells": [1, 1, 1]}})",
        R"("models": [{"model": "hooke", "parameters": {"E": 1e9, "nu": 0, "rho": 1000}}])",
        R"("foundations": [{"where": {"set": "z0"}, "normal": 2e5, "tangential": 5e4},
                           {"where": {"set": "z1"}, "normal": 2e5, "tangential": 5e4}],
           "initial_motion": [{"where": "all", "velocity": [)" +
            motion.str() + R"(]}], "solver": {"integrator": "newmark", "dt": 1e-4, "end": )" +
            std::to_string(std::acos(-1) / 2 / omega) + "}"));
    simulation.run();
    Attributes& a = simulation.attributes();
    double mean = 0, speed = 0;
    for (Index v = 0; v < 8; ++v) {
      mean += (row(a.position(), v)[axis] - row(a.rest(), v)[axis]) / 8;
      speed += row(a.velocity(), v)[axis] / 8;
    }
    EXPECT_NEAR(mean * omega, 1, 1e-3) << "a quarter of a period, along " << axis;
    EXPECT_NEAR(speed, 0, 5e-3);
  }
}

TEST(Foundations, HaveTheTangentOfTheirForces) {
  TestSimulation simulation(scene_of(cube, rubber, R"("foundations": [
      {"where": {"box": {"min": [-1, -1, -1], "max": [2, 2, 0.01]}}, "normal": 3e4, "damping": 70},
      {"where": {"set": "y1"}, "tangential": 2e4, "normal": 1e4}],
      "solver": {"dt": 1e-4, "end": 1e-2})"));
  Foundations& term = foundations_of(simulation);
  Attributes& a = simulation.attributes();
  const std::size_t n = a.vertex_count();
  std::mt19937 engine(7);
  std::uniform_real_distribution<> value(-1, 1);
  std::vector<double> d(3 * n), image(3 * n), by_cells(3 * n);
  std::vector<float> single(4 * n), single_image(4 * n);
  for (std::size_t i = 0; i < d.size(); ++i)
    single[i / 3 * 4 + i % 3] = static_cast<float>(d[i] = value(engine));
  const double dx = 0.7, dv = 30;
  term.add_tangent(d.data(), dx, dv, 0, image.data());
  term.add_tangent_in_single(single.data(), dx, dv, 0, single_image.data());
  term.for_each_tangent(dx, dv, 0, [&](const CellTangents& cells) {
    for (std::size_t l = 0; l < cells.cells; ++l)
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          by_cells[cells.vertices[l] * 3 + i] +=
              cells.values[(j * 3 + i) * 8 + l] * d[cells.vertices[l] * 3 + j];
  });
  const auto forces = [&](double way) {
    for (std::size_t i = 0; i < d.size(); ++i) {
      a.position().rows()[i / 3 * 4 + i % 3] += way * dx * d[i];
      a.velocity().rows()[i / 3 * 4 + i % 3] += way * dv * d[i];
    }
    std::vector<double> rows(4 * n);
    term.add_forces(0, {}, rows.data());
    return rows;
  };
  const auto after = forces(0.5), before = forces(-1);
  double largest = 0;
  for (std::size_t i = 0; i < d.size(); ++i) {
    const std::size_t at = i / 3 * 4 + i % 3;
    largest = std::max(largest, std::abs(image[i]));
    EXPECT_NEAR(image[i], after[at] - before[at], 1e-8);
    EXPECT_NEAR(image[i], by_cells[i], 1e-9);
    EXPECT_NEAR(image[i], single_image[at], 1e-2);
  }
  EXPECT_GT(largest, 1000);
}

/// The sum of the stiffness of all springs along an axis, after what a scene does.
double stiffness_after(const std::string& mesh, const std::string& events, std::size_t axis) {
  TestSimulation simulation(scene_of(mesh, rubber,
                                     R"("foundations": [
      {"where": {"set": "z0"}, "normal": 1e4, "tangential": 3e3}],
      "solver": {"dt": 1e-4, "end": 2e-3}, "events": )" +
                                         events));
  const double before = -force_after(simulation, {0, 0, 1})[2];
  EXPECT_NEAR(before, 1e4, 1e-6);
  simulation.run();
  Vec3 unit{};
  unit[axis] = 1;
  return force_after(simulation, {})[axis] - force_after(simulation, unit)[axis];
}

TEST(Foundations, EachPieceKeepsTheSpringsOfItsPartOfTheSurface) {
  const std::string blade = R"({"at": 5e-4, "cut": {"plane":
      {"point": [0.4, 0.5, 0.5], "normal": [1, 0.3, 0.2]}}})";
  const std::string level = R"({"at": 1e-3, "cut": {"plane": {"point": [0, 0, 0.5],
      "normal": [0, 0, 1]}, "along": "blade"}})";
  for (const std::size_t axis : {std::size_t{0}, std::size_t{2}}) {
    const double whole = axis == 2 ? 1e4 : 3e3;
    EXPECT_NEAR(stiffness_after(cube, "[]", axis), whole, 1e-6);
    EXPECT_NEAR(stiffness_after(cube, "[" + blade + "]", axis), whole, 1e-6);
    EXPECT_NEAR(stiffness_after(cube, "[" + blade + ", " + level + "]", axis), whole, 1e-6);
    EXPECT_NEAR(stiffness_after(cube, "[" + blade + R"(, {"at": 1e-3, "suture": {}}])", axis),
                whole, 1e-6);
    EXPECT_NEAR(stiffness_after(cube, R"([{"at": 1e-3, "cut": {"along": "faces", "plane":
        {"point": [0.33, 0, 0], "normal": [1, 0, 0]}}}])",
                                axis),
                whole, 1e-6);
    EXPECT_NEAR(stiffness_after(cube, R"([{"at": 1e-3, "pierce": {"where":
        {"box": {"min": [0, 0, 0], "max": [0.34, 1, 0.34]}}}}])",
                                axis),
                whole * 2 / 3, 1e-6);
  }
}

// Energy is neither made nor lost by springs; what dampers take is their work.
TEST(Foundations, TheLedgerCloses) {
  for (const char* solver : {R"("integrator": "symplectic-euler", "safety": 0.1)",
                             R"("integrator": "velocity-verlet", "safety": 0.2)",
                             R"("integrator": "newmark", "dt": 2e-4)"}) {
    TestSimulation simulation(scene_of(cube, rubber, R"("foundations": [
        {"where": {"set": "z0"}, "normal": 3e5, "tangential": 1e5, "damping": 2000}],
        "initial_motion": [{"where": "all", "velocity": [1, 0.5, -2], "spin": [0, 2, 0]}],
        "events": [{"at": 0.1, "cut": {"plane": {"point": [0.4, 0.5, 0.5], "normal": [1, 0.3, 0.2]}}}],
        "solver": {"end": 0.2, )" + std::string(solver) + "}"));
    simulation.run();
    const EnergyBalance b = simulation.built().dynamics().balance();
    EXPECT_LT(std::abs(b.balance), 0.01 * b.exchanged) << solver;
    EXPECT_LT(foundations_of(simulation).work(), -100) << "J, " << solver;
  }
}

// A spring to ground holds a body that nothing else holds.
TEST(Foundations, HoldABodyWithoutConstraintsAtRest) {
  TestSimulation simulation(scene_of(cube, rubber, R"("gravity": [0, 0, -1], "foundations": [
      {"where": {"set": "z0"}, "normal": 1e5, "tangential": 1e4}],
      "solver": {"until": "rest", "damping": "auto"})"));
  simulation.run();
  double mean = 0;
  Attributes& a = simulation.attributes();
  for (Index v = 0; v < a.vertex_count(); ++v)
    if (a.rest().get(v, 2) == 0) mean += (a.position().get(v, 2)) / 16;
  EXPECT_NEAR(mean, -1000 / 1e5, 4e-4);
}

}  // namespace
}  // namespace suture::test::foundations_test
