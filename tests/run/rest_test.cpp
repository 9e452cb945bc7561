// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a search for rest reports at its end.
#include <gtest/gtest.h>

#include <cmath>

#include "kernel/base/error.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

Scene until_rest(Scene scene, double tolerance = 1e-6) {
  scene.solver.until_rest = true;
  scene.solver.automatic_damping = true;
  scene.solver.tolerance = tolerance;
  scene.solver.threads = 1;
  return scene;
}

struct Rested {
  RunSummary summary;
  std::string warnings;
};

Rested rested(const Scene& scene) {
  TestSimulation simulation(scene);
  Rested result{simulation.run(), {}};
  for (const auto& warning : simulation.diagnostics.warnings()) result.warnings += warning + "\n";
  return result;
}

TEST(Rest, BelowRoundingItEndsWithAWarning) {
  for (const char* model : {"tm-faure", "mss-baudet"}) {
    const Rested result = rested(until_rest(beam(host(), model, 8, 2, 1), 1e-15));
    EXPECT_EQ(result.summary.outcome, RunSummary::Outcome::at_rest);
    EXPECT_NE(result.warnings.find("rounding of positions"), std::string::npos) << model;
    EXPECT_LT(result.summary.steps, 10'000u);
  }
}

TEST(Rest, WithoutDampingItSaysWhatIsMissing) {
  Scene scene = until_rest(beam(host(), "tm-faure", 8, 2, 1));
  scene.solver.automatic_damping = false;
  try {
    rested(scene);
    FAIL() << "it swings for ever";
  } catch (const NumericalError& error) {
    EXPECT_NE(std::string(error.what()).find("the motion is undamped"), std::string::npos)
        << error.what();
  }
}

// Steps grow with the stiffness of the volume, 11 times, and not with rounding.
TEST(Rest, NearlyIncompressibleTakesAtMostTwentyTimesTheSteps) {
  for (const char* model : {"tm-faure", "mss-baudet"})
    for (const double stiffness : {400e3, 1e10}) {
      const auto steps = [&](double nu) {
        Scene scene = beam(host(), model, 8, 2, 1, {{"nu", nu}, {"E", stiffness}});
        if (scene.models[0].name == "mss-baudet")
          scene = beam(host(), model, 8, 2, 1, {{"nu", nu}, {"E", stiffness}, {"correction", 1}});
        return rested(until_rest(scene)).summary.steps;
      };
      const std::uint64_t smooth = steps(0.3);
      EXPECT_GT(smooth, 100u);
      EXPECT_LT(steps(0.499), 20 * smooth) << model << ", E = " << stiffness;
    }
}

// Corrected springs under the full load come to a stable rest that is a checkerboard.
TEST(Rest, HourglassIsWarnedOf) {
  const auto sag = [](const char* model, double gravity) {
    Scene scene = until_rest(beam(host(), model, 12, 3, gravity), 1e-4);
    if (std::string(model) == "mss-baudet")
      scene = until_rest(beam(host(), model, 12, 3, gravity, {{"correction", 1}}), 1e-4);
    scene.gravity_ramp = {0, 2, true};
    return rested(scene);
  };
  const Rested springs = sag("mss-baudet", 9.8);
  EXPECT_EQ(springs.summary.outcome, RunSummary::Outcome::at_rest);
  EXPECT_NE(springs.warnings.find("elements have hourglassed"), std::string::npos)
      << springs.warnings;
  EXPECT_EQ(sag("mss-baudet", 0.98).warnings.find("elements have hourglassed"), std::string::npos);
  EXPECT_EQ(sag("tm-faure", 9.8).warnings.find("elements have hourglassed"), std::string::npos);
}

}  // namespace
}  // namespace suture::test
