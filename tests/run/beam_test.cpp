// SPDX-License-Identifier: GPL-3.0-or-later
//
// The whole program compared with independent solutions of the same discrete problem.
#include "tests/run/beam.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "tests/reference/beam.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

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
  TestSimulation simulation(at_rest(scene, 1.0, 1e-8));
  const RunSummary summary = simulation.run();
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

/// An integrator that follows the reference at every 0.01 s. The error of a step of this length
/// stays below `tolerance` for the quarter load until 1 s, and `full_tolerance` for the full one
/// until 0.4 s; the references' own errors are below 1e-8 m.
struct Scheme {
  const char* integrator;
  double dt, tolerance, full_tolerance;  ///< s, m
};

void PrintTo(const Scheme& scheme, std::ostream* out) { *out << scheme.integrator; }

class DynamicBeam : public testing::TestWithParam<Scheme> {
 protected:
  /// The largest error of the tip's deflection, m.
  static double error(double gravity, std::span<const double> expected) {
    Scene scene = beam(host(), "tm-faure", 20, 5, gravity);
    scene.solver.integrator = GetParam().integrator;
    scene.solver.dt = GetParam().dt;
    scene.solver.end = 0.01 * static_cast<double>(expected.size() - 1);
    TestSimulation simulation(scene);
    double worst = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      simulation.run_to(0.01 * static_cast<double>(i));
      const double tip = simulation.mean_displacement(beam_tip(5))[1];
      worst = std::max(worst, std::abs(tip - expected[i]));
    }
    RecordProperty("worst_error_m", std::to_string(worst));
    return worst;
  }
};

TEST_P(DynamicBeam, FollowsTheReferenceForASecondUnderAQuarterOfTheLoad) {
  EXPECT_LT(error(2.45, reference::quarter_load_tip_uy), GetParam().tolerance);
}

TEST_P(DynamicBeam, FollowsTheReferenceUnderTheFullLoadUntilRootElementsInvert) {
  EXPECT_LT(error(9.8, reference::full_load_tip_uy), GetParam().full_tolerance);
}

INSTANTIATE_TEST_SUITE_P(CaseI, DynamicBeam,
                         testing::Values(Scheme{"velocity-verlet", 1e-4, 2e-6, 2e-6},
                                         Scheme{"symplectic-euler", 1e-4, 4e-5, 1.5e-4},
                                         Scheme{"newmark", 5e-3, 2.5e-4, 3e-4},
                                         Scheme{"implicit-euler", 5e-3, 7e-3, 8e-3}),
                         [](const auto& test) {
                           std::string name = test.param.integrator;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

// Quarter load, dt = 1e-4 s, 100,000 steps: the total energy at whole steps
// wobbles by less than 1e-4 of the largest kinetic energy and has no trend.
TEST(DynamicBeams, UndampedEnergyHasNoTrend) {
  Scene scene = beam(host(), "tm-faure", 20, 5, 2.45);
  scene.solver.integrator = "velocity-verlet";
  scene.solver.dt = 1e-4;
  const int samples = full_suite() ? 2000 : 400;  // of 50 steps
  scene.solver.end = samples * 50e-4;
  TestSimulation simulation(scene);
  double kinetic = 0, worst = 0, sum_t = 0, sum_e = 0, sum_tt = 0, sum_te = 0;
  const double start = simulation.energies().total();
  for (int i = 1; i <= samples; ++i) {
    simulation.run_to(i * 50e-4);
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
