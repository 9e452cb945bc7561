// SPDX-License-Identifier: GPL-3.0-or-later
//
// Obstacles in explicit steps: Coulomb's law on a slope, Hertz's law, rest, threads, tables.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/base/sanitizer.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/contact_scenes.hpp"
#include "tests/run/csv_table.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

TEST(ContactScenes, ABlockHoldsJustBelowTheAngleOfFrictionAndDoesNotCreep) {
  Scene scene = block_on_floor(2, on_slope(0.3, 0.98), 0.3);
  scene.gravity_ramp = {0, 0.5, true};
  scene.solver.damping = 2;
  scene.solver.end = 120;
  TestSimulation simulation(scene);
  simulation.run_to(20);
  const double held = mean_x(simulation);
  simulation.run_to(120);
  EXPECT_LT(held, 0.02);
  EXPECT_LT(std::abs(mean_x(simulation) - held), 100 * 1e-6 * 0.4);
}

TEST(ContactScenes, ABlockSlidesJustAboveTheAngleOfFriction) {
  Scene scene = block_on_floor(2, on_slope(0.3, 1.02), 0.3);
  scene.gravity_ramp = {0, 0.5, true};
  scene.solver.damping = 2;
  scene.solver.end = 20;
  TestSimulation simulation(scene);
  simulation.run_to(10);
  const double before = mean_x(simulation);
  simulation.run_to(20);
  // The speed of a rigid block with this damping; a soft one is not slower.
  const double speed = sliding_speed(0.3, 1.02, 2);
  EXPECT_GT(mean_x(simulation) - before, 0.9 * 10 * speed);
}

TEST(ContactScenes, ABlockFallsAndComesToRestOnTheFloor) {
  Scene scene = block_on_floor(2, {0, 0, -9.81}, 0.5);
  scene.mesh.box->origin[2] = 0.05;
  scene.solver.until_rest = scene.solver.automatic_damping = true;
  scene.solver.tolerance = 1e-6;
  TestSimulation simulation(scene);
  const RunSummary summary = simulation.run();
  EXPECT_EQ(summary.outcome, RunSummary::Outcome::at_rest);
  const double weight = 1000 * 0.4 * 0.4 * 0.2 * 9.81;
  EXPECT_NEAR(simulation.contact()->loads()[0].force[2], -weight, 1e-5 * weight);
  ASSERT_EQ(simulation.diagnostics.warnings().size(), 2u)
      << "that nothing else holds it, and stability";
  EXPECT_NE(simulation.diagnostics.warnings()[1].find("contact"), std::string::npos);
  for (const double gap : simulation.contact()->gaps(summary.time))
    if (!std::isnan(gap)) {
      EXPECT_GT(gap, -1e-12);
    }
}

/// A block that falls onto a floor.
Scene bouncing_block(bool penalty, double height, double young) {
  Scene scene = block_on_floor(2, {0, 0, -9.81}, 0, young);
  scene.mesh.box->origin[2] = height;
  scene.contact.penalty = penalty;
  return scene;
}

double momentum(Attributes& a) {
  double sum = 0;
  for (Index v = 0; v < a.vertex_count(); ++v) sum += a.mass().get(v, 0) * a.velocity().get(v, 2);
  return sum;
}

/// Motion and strain where the centre is highest after ten bounces, of what gravity has put in, and
/// the energy that falls.
double kept_after_ten_bounces(bool penalty, double height, double young) {
  TestSimulation simulation(bouncing_block(penalty, height, young));
  int tops = 0;
  bool rose = false;
  for (double time = 1e-3; tops < 10 && time < 10; time += 1e-3) {
    simulation.run_to(time);
    const bool rises = momentum(simulation.attributes()) > 0;
    if (rose && !rises) ++tops;
    rose = rises;
  }
  EXPECT_EQ(tops, 10);
  const EnergyBalance energies = simulation.built().dynamics().balance();
  const double fall = 1000 * 0.4 * 0.4 * 0.2 * 9.81 * height;
  return 1 + (energies.kinetic + energies.elastic - energies.work("gravity")) / fall;
}

// The last digits of dt decide where the surface lies in a step, so each case counts as a sample.
TEST(ContactScenes, BouncesConserveEnergyWithSpringsAndLoseItWithImpulses) {
  for (const double height : {0.01, 0.011, 0.05, 0.051, 0.2, 0.21})
    for (const double young : {1e5, 1e6, 1e7})
      EXPECT_NEAR(kept_after_ten_bounces(true, height, young), 1, 0.03)
          << height << " m, " << young << " Pa";
  EXPECT_LT(kept_after_ten_bounces(false, 0.05, 1e6), 0.9);
}

// The springs carry the weight: the block sinks in by weight / stiffness, and no friction holds it.
TEST(ContactScenes, ABlockRestsOnSprings) {
  Scene scene = bouncing_block(true, 0, 1e6);
  scene.solver.until_rest = scene.solver.automatic_damping = true;
  scene.solver.tolerance = 1e-6;
  TestSimulation simulation(scene);
  EXPECT_EQ(simulation.run().outcome, RunSummary::Outcome::at_rest);
  const double weight = 1000 * 0.4 * 0.4 * 0.2 * 9.81;
  EXPECT_NEAR(simulation.contact()->loads()[0].force[2], -weight, 1e-5 * weight);
  double work = 0;  // stored by springs that stiffen from 0 in proportion to the depth: f d / 3
  for (const ContactLaw::Touch& touch : simulation.contact()->touches())
    work += touch.force[2] * simulation.attributes().position().get(touch.vertex, 2) / 3;
  EXPECT_LT(work, 0);
  EXPECT_NEAR(simulation.built().dynamics().balance().work("contact"), work, 1e-2 * std::abs(work));
}

double dissipated_by_pressing(double safety) {
  Scene scene = hertz(2);
  scene.solver.damping = 20;
  scene.solver.safety = safety;
  scene.solver.end = 0.3;
  TestSimulation simulation(scene);
  simulation.run();
  return simulation.built().dynamics().balance().dissipated;
}

// What damping takes from impulses within a step counts as their work.
TEST(ContactScenes, DampingDissipatesTheSameWithAnyStep) {
  const double fine = dissipated_by_pressing(0.1);
  EXPECT_NEAR(dissipated_by_pressing(0.8), fine, 0.02 * fine);
}

double moving_over_hertz(Index n) {
  Scene scene = hertz(n);
  scene.solver.until_rest = scene.solver.automatic_damping = true;
  scene.solver.tolerance = 1e-3;
  return over_hertz(scene);
}

TEST(ContactScenes, ASphereInABlockFollowsHertz) {
  const double coarse = moving_over_hertz(2);
  EXPECT_NEAR(coarse, 1, 0.15);
  EXPECT_NEAR(moving_over_hertz(4), 1, 0.08);
}

TEST(ContactScenes, HaveTheSameBitsForAnyNumberOfThreads) {
  std::vector<double> first;
  for (const unsigned threads : thread_counts()) {
    Scene scene = block_on_floor(14, {2, 0, -9.81}, 0.3);
    Obstacle ball{"ball", "/contact/obstacles/1", Sphere{{0.2, 0.2, 0.301}, 0.1}, {}, 0.2};
    ball.motion.stations = {{0, {}, 0}, {0.1, {0.02, 0, -0.02}, 0}};
    scene.contact.obstacles.push_back(ball);
    scene.solver.threads = threads;
    scene.solver.end = 0.02;
    TestSimulation simulation(scene);
    simulation.run();
    const Column& x = simulation.attributes().position();
    std::vector<double> all(x.rows(), x.rows() + 4 * std::size_t{x.size()});
    for (const ContactLaw::Load& load : simulation.contact()->loads())
      all.insert(all.end(), load.force.begin(), load.force.end());
    EXPECT_GT(std::abs(all.back()), 0) << "both touch";
    if (threads == 1) first = all;
    EXPECT_EQ(all, first) << threads << " threads";
  }
}

TEST(ContactScenes, WriteForcesAndEnergies) {
  TemporaryFolder folder;
  Scene scene = block_on_floor(2, {1, 0, -9.81}, 0.3);
  scene.contact.obstacles.push_back(
      {"wall", "/contact/obstacles/1", Box{{0.45, -1, -1}, {1, 2, 2}}, {}, 0});
  scene.solver.end = 1;
  scene.solver.damping = 1;
  scene.output.enabled = true;
  scene.output.directory = folder.path() / "out";
  scene.output.fields = {"displacement", "contact_force", "gap"};
  scene.output.energies_every = scene.output.tools_every = 1;
  scene.output.obstacles = true;
  TestSimulation simulation(scene);
  simulation.run();

  const CsvTable tools(folder.path() / "out" / "tools.csv");
  ASSERT_EQ(tools.columns.size(), 2u + 2 * 6);
  EXPECT_EQ(tools.columns[2], "floor force x [N]");
  EXPECT_EQ(tools.columns.back(), "wall torque z [N m]");
  const ContactLaw::Load& floor = simulation.contact()->loads()[0];
  EXPECT_EQ(tools.last("floor force z [N]"), floor.force[2]);
  EXPECT_LT(floor.force[2], -100);

  const CsvTable table(folder.path() / "out" / "energies.csv");
  EXPECT_LT(table.last("friction [J]"), 0);
  const auto column = [&](const char* name) { return table.column(std::string(name) + " [J]"); };
  const std::vector<double> kinetic = column("kinetic"), elastic = column("elastic");
  double sum = table.last("balance [J]") - table.last("dissipated [J]") + kinetic[0] + elastic[0];
  for (const char* work :
       {"gravity", "loads", "pressure", "contact", "friction", "prescribed", "models", "events"})
    sum += column(work).back();
  EXPECT_NEAR(kinetic.back() + elastic.back(), sum, 1e-9 * table.last("gravity [J]"));
  EXPECT_LT(std::abs(table.last("balance [J]")), 0.02 * table.last("gravity [J]"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out" / "obstacles_0000.vtu"));
}

}  // namespace
}  // namespace suture::test
