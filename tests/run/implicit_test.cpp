// SPDX-License-Identifier: GPL-3.0-or-later
//
// Implicit integrators: their orders, their stability, and what they conserve.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/reference/beam.hpp"
#include "tests/run/beam.hpp"

namespace suture::test {
namespace {

PluginHost& host() {
  static PluginHost plugins;
  return plugins;
}

Scene swinging(const char* integrator, double dt, double end) {
  Scene scene = beam(host(), "tm-faure", 8, 2, 2.45);
  scene.solver.integrator = integrator;
  scene.solver.dt = dt;
  scene.solver.end = end;
  scene.solver.step_tolerance = 1e-11;
  return scene;
}

Vec3 tip_after(const Scene& scene) {
  Diagnostics diagnostics;
  Simulation simulation(scene, host(), diagnostics);
  Observer nobody;
  simulation.run(nobody);
  return simulation.mean_displacement(beam_tip(2));
}

double error(const char* integrator, double dt) {
  static const double exact = tip_after(swinging("velocity-verlet", 2e-5, 0.1))[1];
  return std::abs(tip_after(swinging(integrator, dt, 0.1))[1] - exact);
}

TEST(ImplicitIntegrators, ConvergeWithTheirOrder) {
  EXPECT_NEAR(std::log2(error("implicit-euler", 1e-3) / error("implicit-euler", 5e-4)), 1, 0.1);
  EXPECT_NEAR(std::log2(error("newmark", 1e-3) / error("newmark", 5e-4)), 2, 0.1);
}

// The reference's own error is below 1e-8 m, that of 5 ms of the second order.
TEST(ImplicitIntegrators, NewmarkFollowsTheReferenceWithStepsTwentyTimesTheStableOne) {
  Scene scene = beam(host(), "tm-faure", 20, 5, 2.45);
  scene.solver.integrator = "newmark";
  scene.solver.dt = 5e-3;
  scene.solver.end = 0.5;
  Diagnostics diagnostics;
  Simulation simulation(scene, host(), diagnostics);
  Observer nobody;
  for (int i = 0; i <= 50; i += 10) {
    simulation.run_to(0.01 * i, nobody);
    EXPECT_NEAR(simulation.mean_displacement(beam_tip(5))[1], reference::quarter_load_tip_uy[i],
                2e-3);
  }
}

TEST(ImplicitIntegrators, NewmarkKeepsTheEnergyAndEulerLosesIt) {
  for (const bool keeps : {true, false}) {
    const Scene scene = swinging(keeps ? "newmark" : "implicit-euler", 5e-3, 2);
    Diagnostics diagnostics;
    Simulation simulation(scene, host(), diagnostics);
    Observer nobody;
    const double start = simulation.energies().total();
    double largest = 0, kinetic = 0;
    for (int i = 1; i <= 40; ++i) {
      simulation.run_to(0.05 * i, nobody);
      const Energies e = simulation.energies();
      largest = std::max(largest, e.total() - start);
      kinetic = std::max(kinetic, e.kinetic);
    }
    EXPECT_LT(largest, 0.02 * kinetic);
    if (keeps)
      EXPECT_LT(std::abs(simulation.energies().total() - start), 0.02 * kinetic);
    else
      EXPECT_LT(simulation.energies().total() - start, -0.2 * kinetic);
  }
}

// Steps of a thousand times the stable one: bounded, and at rest in the end.
TEST(ImplicitIntegrators, EulerTakesAnyStep) {
  Diagnostics diagnostics;
  Simulation simulation(swinging("implicit-euler", 0.25, 25), host(), diagnostics);
  Observer nobody;
  simulation.run(nobody);
  Scene rest = swinging("static", 1, 1);
  EXPECT_NEAR(simulation.mean_displacement(beam_tip(2))[1], tip_after(rest)[1], 1e-6);
}

TEST(ImplicitIntegrators, CutsActBetweenSteps) {
  Scene scene = swinging("newmark", 5e-3, 0.3);
  Diagnostics diagnostics;
  Simulation simulation(scene, host(), diagnostics);
  Observer nobody;
  simulation.run_to(0.1, nobody);
  Event cut;
  cut.what = CutPlane{{0.5, 0.125, 0.125}, {1, 0, 0}};
  const Index before = simulation.attributes().vertex_count();
  simulation.apply(cut, nobody);
  EXPECT_EQ(simulation.attributes().vertex_count(), before + 9);
  simulation.run(nobody);
  EXPECT_LT(simulation.mean_displacement(beam_tip(2))[1], -0.03) << "the end falls";
}

}  // namespace
}  // namespace suture::test
