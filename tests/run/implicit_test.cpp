// SPDX-License-Identifier: GPL-3.0-or-later
//
// Implicit integrators: their orders, their stability, and what they conserve.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

Scene swinging(const char* integrator, double dt, double end) {
  Scene scene = beam(host(), "tm-faure", 8, 2, 2.45);
  scene.solver.integrator = integrator;
  scene.solver.dt = dt;
  scene.solver.end = end;
  scene.solver.step_tolerance = 1e-11;
  return scene;
}

Vec3 tip_after(const Scene& scene) {
  TestSimulation simulation(scene);
  simulation.run();
  return simulation.mean_displacement(beam_tip(2));
}

double error(const char* integrator, double dt) {
  static const double exact = tip_after(swinging("velocity-verlet", 2e-5, 0.1))[1];
  return std::abs(tip_after(swinging(integrator, dt, 0.1))[1] - exact);
}

TEST(Integrators, ConvergeWithTheirOrder) {
  const auto order = [](const char* integrator, double dt) {
    return std::log2(error(integrator, dt) / error(integrator, dt / 2));
  };
  EXPECT_NEAR(order("implicit-euler", 1e-3), 1, 0.1);
  EXPECT_NEAR(order("newmark", 1e-3), 2, 0.1);
  EXPECT_NEAR(order("symplectic-euler", 1e-3), 1, 0.1);
  EXPECT_NEAR(order("velocity-verlet", 1e-3), 2, 0.1);
}

TEST(ImplicitIntegrators, NewmarkKeepsTheEnergyAndEulerLosesIt) {
  for (const bool keeps : {true, false}) {
    const Scene scene = swinging(keeps ? "newmark" : "implicit-euler", 5e-3, 2);
    TestSimulation simulation(scene);
    const double start = simulation.energies().total();
    double largest = 0, kinetic = 0;
    for (int i = 1; i <= 40; ++i) {
      simulation.run_to(0.05 * i);
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
  TestSimulation simulation(swinging("implicit-euler", 0.25, 25));
  simulation.run();
  Scene rest = swinging("static", 1, 1);
  EXPECT_NEAR(simulation.mean_displacement(beam_tip(2))[1], tip_after(rest)[1], 1e-6);
}

TEST(ImplicitIntegrators, CutsActBetweenSteps) {
  Scene scene = swinging("newmark", 5e-3, 0.3);
  TestSimulation simulation(scene);
  simulation.run_to(0.1);
  Event cut;
  cut.what = CutPlane{{0.5, 0.125, 0.125}, {1, 0, 0}};
  const Index before = simulation.attributes().vertex_count();
  simulation.apply(cut);
  EXPECT_EQ(simulation.attributes().vertex_count(), before + 9);
  simulation.run();
  EXPECT_LT(simulation.mean_displacement(beam_tip(2))[1], -0.03) << "the end falls";
}

}  // namespace
}  // namespace suture::test
