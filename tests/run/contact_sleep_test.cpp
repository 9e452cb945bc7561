// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pieces that touch obstacles and each other fall asleep together, and wake when something comes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "kernel/base/archive.hpp"
#include "kernel/contact/contact.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/events.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

constexpr double edge = 0.05, gravity = 9.81, density = 200, ready = 4;

/// Blocks of 2 x 2 x 2 elements: A, on it B and in the air C; D stands beside them on the floor.
Scene tower() {
  Scene scene = beam(host(), "tm-faure", 1, 1, 0, {{"E", 1e5}, {"rho", density}});
  scene.mesh.box.reset();
  scene.mesh.voxels = VoxelOptions{
      .size = edge,
      .layers = 2,
      .rows = {"CC....", "CC....", "......", "BB....", "BB....", "......", "AA..DD", "AA..DD"}};
  scene.constraints.clear();
  scene.gravity = {0, -gravity, 0};
  scene.contact.obstacles = {{"floor", "", HalfSpace{{0, 0, 0}, {0, 1, 0}}, {}, 0.5}};
  scene.contact.pieces = true;
  scene.contact.friction = 0.5;
  scene.solver.damping = 5;
  scene.solver.end = 20;
  scene.solver.sleep_acceleration = 0.1;
  scene.solver.sleep_velocity = 1e-3;
  return scene;
}

/// The numbers of islands asleep that a run reports.
struct SleepListener : Observer {
  void on_message(const std::string& text) override {
    const auto at = text.find(" s: ");
    if (text.find("asleep") != std::string::npos) asleep.push_back(std::stoi(text.substr(at + 4)));
  }
  std::vector<int> asleep;
};

struct Tower {
  explicit Tower(const Scene& scene) : simulation(scene, host(), diagnostics) {}
  void run_to(double time) { simulation.run_to(time, listener); }
  int asleep() const { return listener.asleep.empty() ? 0 : listener.asleep.back(); }
  /// The mean height of the vertices of an island, which the lowest elements number first: A, D, B,
  /// C.
  double mean_height(Index island) {
    Attributes& a = simulation.attributes();
    double sum = 0, count = 0;
    for (Index v = 0; v < a.vertex_count(); ++v) {
      if (island_of(v) != island) continue;
      sum += a.position().get(v, 1);
      ++count;
    }
    return sum / count + simulation.origin()[1];
  }
  Index island_of(Index vertex) {
    return simulation.built().body().islands().of(simulation.complex().dart_of(0, vertex) / 24);
  }
  std::vector<double> positions() {
    const Column& x = simulation.attributes().position();
    return {x.rows(), x.rows() + 4 * std::size_t{x.size()}};
  }
  const PieceContact& pieces() {
    return *dynamic_cast<const Contact&>(*simulation.contact()).pieces();
  }
  double force_on_floor() { return simulation.contact()->loads()[0].force[1]; }

  Diagnostics diagnostics;
  Simulation simulation;
  SleepListener listener;
};

constexpr double weight_of_block = 8 * edge * edge * edge * density * gravity;

struct EachScheme : testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(SleepInContact, EachScheme, testing::Values("symplectic-euler", "xpbd"));

TEST_P(EachScheme, AStackFallsAsleepAndCostsNothing) {
  Scene scene = tower();
  scene.solver.integrator = GetParam();
  if (GetParam() == std::string("xpbd")) scene.solver.softness = 0.05;
  Tower tower_of(scene);
  tower_of.run_to(ready);
  ASSERT_EQ(tower_of.asleep(), 4);
  const std::vector<double> place = tower_of.positions();
  const double force = tower_of.force_on_floor();
  EXPECT_NEAR(force, -4 * weight_of_block, 0.01 * 4 * weight_of_block);
  tower_of.run_to(ready + 0.2);
  EXPECT_EQ(tower_of.positions(), place);
  EXPECT_EQ(tower_of.force_on_floor(), force) << "the forces stay, also in tables";
  EXPECT_TRUE(tower_of.pieces().touches().empty()) << "pairs of sleepers are left out";
  EXPECT_FALSE(tower_of.pieces().asleep().empty());
}

TEST(SleepInContact, EndsWhereARunWithoutSleepEnds) {
  Scene scene = tower();
  Tower asleep(scene);
  scene.solver.sleep_acceleration = scene.solver.sleep_velocity = 0;
  Tower awake(scene);
  for (Tower* one : {&asleep, &awake}) one->run_to(5);
  ASSERT_EQ(asleep.asleep(), 4);
  const std::vector<double> a = asleep.positions(), b = awake.positions();
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-3 * edge) << i;
}

/// Lifts C, which falls while the others sleep.
void lift(Tower& tower_of, double height) {
  tower_of.simulation.change_motion([&](Attributes& a) {
    for (Index v = 0; v < a.vertex_count(); ++v)
      if (tower_of.island_of(v) == 3) a.position().set(v, 1, a.position().get(v, 1) + height);
  });
}

TEST(SleepInContact, WhatFallsOnAStackWakesItAndNothingElse) {
  Tower tower_of(tower());
  lift(tower_of, 10);  // it arrives after 5 s, at 2 m/s
  tower_of.run_to(ready);
  ASSERT_EQ(tower_of.asleep(), 3);
  EXPECT_GT(tower_of.mean_height(3), 0.5);
  const double lone = tower_of.mean_height(1);
  tower_of.run_to(ready + 2);
  const auto& heard = tower_of.listener.asleep;
  ASSERT_NE(std::ranges::find(heard, 1), heard.end()) << "A and B wake, and D does not";
  EXPECT_EQ(tower_of.mean_height(1), lone);
  tower_of.run_to(12);
  EXPECT_EQ(tower_of.asleep(), 4);
  EXPECT_NEAR(tower_of.mean_height(3), 5 * edge, 0.05 * edge);
  EXPECT_NEAR(tower_of.force_on_floor(), -4 * weight_of_block, 0.01 * 4 * weight_of_block);
}

TEST(SleepInContact, AnOperationWakes) {
  Tower tower_of(tower());
  tower_of.run_to(ready);
  ASSERT_EQ(tower_of.asleep(), 4);
  Event cut = event_of(CutPlane{{edge, 0, 0}, {1, 0, 0}});
  tower_of.simulation.apply(cut, tower_of.listener);
  EXPECT_TRUE(tower_of.pieces().asleep().empty());
  const double before = tower_of.force_on_floor();
  tower_of.run_to(ready + 0.02);
  EXPECT_FALSE(tower_of.pieces().touches().empty());
  EXPECT_NEAR(tower_of.force_on_floor(), before, 0.1 * std::abs(before))
      << "it wakes with its load";
}

TEST(SleepInContact, ChangesFromOutsideWake) {
  Tower tower_of(tower());
  tower_of.run_to(ready);
  ASSERT_EQ(tower_of.asleep(), 4);
  lift(tower_of, 0.1);
  tower_of.run_to(ready + 0.02);
  EXPECT_FALSE(tower_of.pieces().touches().empty());
}

TEST(SleepInContact, AFloorThatBeginsToMoveWakesAndCarriesWhatStandsOnIt) {
  for (const double way : {0.02, -0.1}) {  // up slowly, and away faster than the blocks fall
    Scene scene = tower();
    const double time = way > 0 ? 0.5 : 0.05;
    scene.contact.obstacles[0].motion.stations = {{ready, {}, 0}, {ready + time, {0, way, 0}, 0}};
    Tower tower_of(scene);
    tower_of.run_to(ready - 0.1);
    ASSERT_EQ(tower_of.asleep(), 4) << "before the floor moves";
    std::vector<double> before;
    for (Index island = 0; island < 4; ++island) before.push_back(tower_of.mean_height(island));
    tower_of.run_to(10);
    EXPECT_EQ(tower_of.asleep(), 4);
    for (Index island = 0; island < 4; ++island)
      EXPECT_NEAR(tower_of.mean_height(island), before[island] + way, 0.01 * edge) << island;
    for (const double gap : tower_of.simulation.contact()->gaps(tower_of.simulation.time()))
      if (!std::isnan(gap)) {
        EXPECT_GT(gap, -1e-9);
      }
  }
}

TEST(SleepInContact, WhatPassesFarAwayWakesNothing) {
  Scene scene = tower();
  Obstacle ball{"ball", "", Sphere{{1, 0.1, 0.05}, 0.05}, {}, 0};
  ball.motion.stations = {{0, {}, 0}, {20, {-0.3, 0, 0}, 0}};
  scene.contact.obstacles.push_back(ball);
  Tower tower_of(scene);
  tower_of.run_to(8);
  EXPECT_EQ(tower_of.asleep(), 4);
  EXPECT_LE(tower_of.listener.asleep.size(), 4u);
}

// The ball keeps D awake; then it has gone on.
TEST(SleepInContact, NothingFallsAsleepBesideAnObstacleThatMoves) {
  Scene scene = tower();
  Obstacle ball{"ball", "", Sphere{{0.36, 0.05, 0.05}, 0.05}, {}, 0};
  ball.motion.stations = {{0, {}, 0}, {6, {0, 0, 0.02}, 0}};
  scene.contact.obstacles.push_back(ball);
  Tower tower_of(scene);
  tower_of.run_to(5.9);
  EXPECT_EQ(tower_of.asleep(), 3);
  tower_of.run_to(8);
  EXPECT_EQ(tower_of.asleep(), 4);
}

}  // namespace
}  // namespace suture::test
