// SPDX-License-Identifier: GPL-3.0-or-later
//
// The whole program compared with independent solutions of the same discrete problem.
#include "tests/run/beam.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/reference/beam.hpp"

namespace suture::test {
namespace {

PluginHost& host() {
  static PluginHost plugins;
  return plugins;
}

bool full_suite() { return std::getenv("SUTURE_FULL") != nullptr; }

Scene at_rest(Scene scene, double ramp, double tolerance) {
  scene.gravity_ramp = {0, ramp, true};
  scene.solver.until_rest = true;
  scene.solver.automatic_damping = true;
  scene.solver.tolerance = tolerance;
  return scene;
}

class StaticBeam : public testing::TestWithParam<reference::StaticBeam> {};

// 1e-6 of the tip deflection, both quadratures.
TEST_P(StaticBeam, AgreesWithTheIndependentSolution) {
  const reference::StaticBeam& expected = GetParam();
  const auto n = static_cast<Index>(expected.cells_y);
  Scene scene = beam(host(), "tm-faure", static_cast<Index>(expected.cells_x), n, expected.gravity);
  const suture_parameter& quadrature =
      *std::find_if(scene.models[0].model->parameters,
                    scene.models[0].model->parameters + scene.models[0].model->parameter_count,
                    [](const suture_parameter& p) { return std::string(p.name) == "quadrature"; });
  const auto choice = std::find(quadrature.choices, quadrature.choices + quadrature.choice_count,
                                std::string(expected.quadrature)) -
                      quadrature.choices;
  scene.models[0]
      .parameters[static_cast<std::size_t>(&quadrature - scene.models[0].model->parameters)] =
      static_cast<double>(choice);
  Diagnostics diagnostics;
  const Scene rest = at_rest(scene, 1.0, 1e-8);
  Simulation simulation(rest, host(), diagnostics);
  Observer nobody;
  const RunSummary summary = simulation.run(nobody);
  EXPECT_EQ(summary.outcome, RunSummary::Outcome::at_rest);
  const Vec3 tip = simulation.mean_displacement(beam_tip(n));
  const double scale = std::abs(expected.tip_uy);
  RecordProperty("steps", static_cast<int>(summary.steps));
  EXPECT_NEAR(tip[1], expected.tip_uy, 1e-6 * scale) << summary.steps << " steps";
  EXPECT_NEAR(tip[0], expected.tip_ux, 1e-6 * scale);
  EXPECT_NEAR(tip[2], 0, 1e-6 * scale);
  EXPECT_NEAR(simulation.energies().elastic, expected.strain_energy, 1e-5 * expected.strain_energy);
}

INSTANTIATE_TEST_SUITE_P(CaseA, StaticBeam, testing::ValuesIn(reference::static_beams),
                         [](const auto& test) {
                           std::string name = test.param.name;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

// Follows the reference at every 0.01 s. The error of dt = 1e-4 s is of second
// order; the reference's own is below 1e-8 m.
void follow(double gravity, const double* expected, int count, double tolerance) {
  Scene scene = beam(host(), "tm-faure", 20, 5, gravity);
  scene.solver.integrator = "velocity-verlet";
  scene.solver.dt = 1e-4;
  scene.solver.end = 0.01 * (count - 1);
  Diagnostics diagnostics;
  Simulation simulation(scene, host(), diagnostics);
  Observer nobody;
  double worst = 0;
  for (int i = 0; i < count; ++i) {
    simulation.run_to(0.01 * i, nobody);
    worst = std::max(worst, std::abs(simulation.mean_displacement(beam_tip(5))[1] - expected[i]));
  }
  testing::Test::RecordProperty("worst_error_m", std::to_string(worst));
  EXPECT_LT(worst, tolerance);
  EXPECT_GT(std::abs(expected[count - 1]), 0.1) << "the beam must have moved";
}

TEST(DynamicBeam, QuarterLoadFollowsTheReferenceForASecond) {
  follow(2.45, reference::quarter_load_tip_uy,
         static_cast<int>(std::size(reference::quarter_load_tip_uy)), 2e-6);
}

TEST(DynamicBeam, FullLoadFollowsTheReferenceUntilRootElementsInvert) {
  follow(9.8, reference::full_load_tip_uy, static_cast<int>(std::size(reference::full_load_tip_uy)),
         2e-6);
}

// Quarter load, dt = 1e-4 s, 100,000 steps: the total energy at whole steps
// wobbles by less than 1e-4 of the largest kinetic energy and has no trend.
TEST(DynamicBeam, UndampedEnergyHasNoTrend) {
  Scene scene = beam(host(), "tm-faure", 20, 5, 2.45);
  scene.solver.integrator = "velocity-verlet";
  scene.solver.dt = 1e-4;
  const int samples = full_suite() ? 2000 : 400;  // of 50 steps
  scene.solver.end = samples * 50e-4;
  Diagnostics diagnostics;
  Simulation simulation(scene, host(), diagnostics);
  Observer nobody;
  double kinetic = 0, worst = 0, sum_t = 0, sum_e = 0, sum_tt = 0, sum_te = 0;
  const double start = simulation.energies().total();
  for (int i = 1; i <= samples; ++i) {
    simulation.run_to(i * 50e-4, nobody);
    const Energies e = simulation.energies();
    const double error = e.total() - start, t = static_cast<double>(i) / samples;
    kinetic = std::max(kinetic, e.kinetic);
    worst = std::max(worst, std::abs(error));
    sum_t += t, sum_e += error, sum_tt += t * t, sum_te += t * error;
  }
  const double trend = (samples * sum_te - sum_t * sum_e) / (samples * sum_tt - sum_t * sum_t);
  ASSERT_GT(kinetic, 1.0) << "J; the beam must have moved";
  EXPECT_LT(worst / kinetic, 1e-4);
  EXPECT_LT(std::abs(trend) / kinetic, 1e-7) << "over the whole run";
}

}  // namespace
}  // namespace suture::test
