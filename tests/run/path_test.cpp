// SPDX-License-Identifier: GPL-3.0-or-later
//
// Paths of equilibria through limit points, compared with a closed form and with the same path
// under a prescribed displacement, which has no limit point.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "kernel/base/error.hpp"
#include "tests/run/equilibrium.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

using testing::HasSubstr;

Scene along_the_path(Scene scene, double end, unsigned frames) {
  scene.solver.integrator = "static";
  scene.solver.follow_path = true;
  scene.solver.end = end;
  scene.solver.dt = end / frames;
  return scene;
}

struct Heard : Observer {
  void on_message(const std::string& text) override { messages.push_back(text); }
  std::vector<std::string> messages;
};

/// The number that follows `words` in a text.
double number_after(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(words);
  if (at == std::string::npos) return std::nan("");
  return std::stod(text.substr(at + words.size()));
}

// A cube pressed beyond the limit of St Venant-Kirchhoff: the nominal stress E s (s^2 - 1) / 2 is
// largest at the stretch s = 1/sqrt 3 and falls to 0 with the height of the cube.
TEST(Path, BeyondItsLimitAPressedCubeCarriesLess) {
  const double young = 1e5, limit = young / std::sqrt(27.0), pressure = limit / 0.77;
  Scene scene =
      block(host(), "tm-faure", {1, 1, 1}, {1, 1, 1}, {{"E", young}, {"nu", 0.3}, {"rho", 1000}});
  hold(scene, at({0, any, any}), 1);
  hold(scene, at({any, 0, any}), 2);
  hold(scene, at({any, any, 0}), 4);
  load(scene, at({1, any, any}), {-pressure, 0, 0});
  TestSimulation simulation(along_the_path(scene, 1, 1));
  Heard heard;
  try {
    simulation.run(heard);
    FAIL() << "there is no equilibrium";
  } catch (const NumericalError& error) {
    EXPECT_NEAR(number_after(error.what(), "after limit points at "), 77, 0.03) << error.what();
    EXPECT_LT(number_after(error.what(), "ends at "), 70) << error.what();
  }
  ASSERT_EQ(heard.messages.size(), 1u);
  EXPECT_THAT(heard.messages[0], HasSubstr("t = 0 s to 1 s: the path of equilibria has a limit"));
}

// ------------------------------------------------------------ snap-through --

constexpr double height = 0.02, shortening = 0.002, up = 0.02, down = 0.1;

Selection mid_edge() { return at({0.5, height, any}); }

/// Half of a strip whose ends are pushed together; the other half is its mirror image at x = 0.5 m.
Scene half_strip() {
  Scene scene = block(host(), "tm-faure", {0.5, height, 0.1}, {8, 1, 1},
                      {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}, {"element", 1}});
  hold(scene, at({0, any, any}), 7, {shortening, 0, 0});
  hold(scene, at({0.5, any, any}), 1);
  return scene;
}

/// The force on the middle of the strip, upwards, that holds it at the height `raised`.
double force_at(double raised) {
  Scene scene = half_strip();
  hold(scene, mid_edge(), 2, {0, raised, 0});
  return Equilibrium(scene, 4).reaction(mid_edge())[1];
}

void push(Scene& scene, double force, double from) {
  Load push;
  push.value = {0, force, 0};
  push.where = mid_edge();
  push.ramp = {from, from + 1, false};
  scene.loads.push_back(push);
}

/// The smallest value on the way down: from a scan and a parabola through its neighbours.
double least_force(double from, double to) {
  const int parts = 40;
  std::vector<double> force;
  for (int i = 0; i <= parts; ++i) force.push_back(force_at(from + i * (to - from) / parts));
  const auto least = std::ranges::min_element(force);
  const double before = least[-1], after = least[1], bend = before - 2 * *least + after;
  return *least - (after - before) * (after - before) / (8 * bend);
}

// The strip bends upwards, is pressed down in the middle, snaps through, and carries the load on
// the other side.
TEST(Path, AStripThatSnapsThroughAgreesWithAPrescribedDisplacement) {
  Scene scene = half_strip();
  push(scene, up, 0);
  push(scene, -down, 1);
  TestSimulation simulation(along_the_path(scene, 2, 2));
  Heard heard;
  EXPECT_EQ(simulation.run(heard).outcome, RunSummary::Outcome::finished);
  const double end = simulation.mean_displacement(mid_edge())[1];
  EXPECT_LT(end, 0);
  EXPECT_NEAR(force_at(end), up - down, 1e-6 * down);

  ASSERT_EQ(heard.messages.size(), 2u);
  EXPECT_THAT(heard.messages[0], HasSubstr("is largest"));
  EXPECT_THAT(heard.messages[1], HasSubstr("is smallest"));
  const double largest = number_after(heard.messages[0], "largest, ") / 100;
  EXPECT_NEAR(up - largest * down, least_force(0.08, 0), 1e-3 * largest * down)
      << heard.messages[0];
}

// A motion has no limit point: the equilibria are those of load steps.
TEST(Path, OfAMotionLeadsToItsEnd) {
  Scene scene = half_strip();
  hold(scene, mid_edge(), 2, {0, 0.03, 0});
  TestSimulation simulation(along_the_path(scene, 1, 2));
  Heard heard;
  EXPECT_EQ(simulation.run(heard).outcome, RunSummary::Outcome::finished);
  EXPECT_TRUE(heard.messages.empty());
  const double expected = Equilibrium(scene, 4).energy();
  EXPECT_NEAR(simulation.energies().elastic, expected, 1e-6 * expected);
}

// A motion that begins late, ends early, or is at rest at both ends, with and without a load that
// goes on: there is no direction where nothing moves any more.
TEST(Path, LeadsOnWhereMotionsBeginAndEnd) {
  const TimeRamp ramps[] = {
      {0, 0.5, false}, {0, 0.5, true}, {0.5, 1, false}, {0.25, 0.75, true}, {0, 1, true}};
  for (const TimeRamp& ramp : ramps)
    for (const bool has_load : {false, true}) {
      Scene scene = half_strip();
      hold(scene, mid_edge(), 2, {0, 0.03, 0});
      for (Constraint& constraint : scene.constraints) constraint.ramp = ramp;
      if (has_load) load(scene, at({0.5, any, any}), {0, 0, 10});
      TestSimulation simulation(along_the_path(scene, 1, 1));
      Heard heard;
      EXPECT_EQ(simulation.run(heard).outcome, RunSummary::Outcome::finished);
      EXPECT_TRUE(heard.messages.empty()) << heard.messages[0];
      const double expected = Equilibrium(scene, 4).energy();
      EXPECT_NEAR(simulation.energies().elastic, expected, 1e-6 * expected)
          << ramp.from << " to " << ramp.to << ", smooth: " << ramp.smooth;
    }
}

TEST(Path, OfStepsInWhichNothingChangesStaysWhereItIs) {
  Scene scene = half_strip();
  scene.gravity = {0, -0.1, 0};
  scene.constraints[0].moves = false;
  TestSimulation one(along_the_path(scene, 1, 1)), three(along_the_path(scene, 3, 3));
  Heard heard;
  one.run(heard);
  three.run(heard);
  const double sag = one.mean_displacement(mid_edge())[1];
  EXPECT_LT(sag, -1e-4);
  EXPECT_NEAR(three.mean_displacement(mid_edge())[1], sag, 1e-8 * std::abs(sag));
}

}  // namespace
}  // namespace suture::test
