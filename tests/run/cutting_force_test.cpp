// SPDX-License-Identifier: GPL-3.0-or-later
//
// Blades that tissue resists: what cutting takes, and what a blade does that is too weak.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "kernel/base/error.hpp"
#include "kernel/forces/contact_law.hpp"
#include "tests/base/sanitizer.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/events.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

constexpr double toughness = 300;  // J/m^2
const Vec3 tip{-0.1, 0.2, 0.2}, top{-0.1, 0.2, 0.6};

CellValues values(double elsewhere) {
  CellValues result;
  result.elsewhere = {elsewhere};
  result.path = "/events/0/cut/blade/resistance/toughness";
  return result;
}

/// A block of 0.8 x 0.4 x 0.4 m, held at the bottom. A blade far below its handle is drawn through
/// it along x.
class CuttingForce : public testing::Test {
 protected:
  CuttingForce() {
    scene.mesh.box = BoxOptions{{0, 0, 0}, {0.8, 0.4, 0.4}, {16, 8, 8}, {1, 1, 1}};
    scene.constraints[0].where.what = Selection::Named{"z0"};
    Obstacle handle{"handle", "/contact/obstacles/0", Sphere{{0, 0.2, 3}, 0.1}};
    handle.motion.stations = {{0, {}, 0}, {1.2, {1.2, 0, 0}, 0}};
    scene.contact.obstacles = {handle};
    scene.solver.damping = 3;
    scene.solver.end = 1.2;
    CutBlade blade;
    blade.carried = CutBlade::Carried{0, "handle", {tip, top}};
    blade.resistance = CutBlade::Resistance{values(toughness)};
    scene.events = {event_of(blade)};
  }
  CutBlade& blade() { return std::get<CutBlade>(scene.events[0].what); }
  RigidPath& motion() { return scene.contact.obstacles[0].motion; }

  /// To the end, with the force that drives the handle along x in each step. That of a compliant
  /// one drives it by its hand.
  void run() {
    Diagnostics diagnostics;
    simulation = std::make_unique<Simulation>(scene, host(), diagnostics);
    Observer nobody;
    double time = 0;
    bool runs = true;
    while (runs) {
      runs = !simulation->advance({{}, 1}, nobody);
      const double dt = simulation->time() - time;
      time = simulation->time();
      if (dt == 0) continue;
      const Pose now = motion().pose(time), before = motion().pose(time - dt);
      const auto tool = simulation->contact()->tool_state(0);
      if (tool) lag = now.translation[0] - tool->pose.translation[0];
      lags.push_back(lag);
      forces.push_back(tool ? -tool->hand_force[0] : -simulation->contact()->loads()[0].force[0]);
      work += forces.back() * (now.translation[0] - before.translation[0]);
    }
    const RunSummary summary = simulation->run(nobody);
    cut = summary.faces_cut;
    divided = summary.elements_cut;
    energies = simulation->built().dynamics().balance();
    EXPECT_LT(std::abs(energies.balance), 0.01 * energies.exchanged);
  }
  /// To 0.4 m, back, and through.
  void run_there_and_back(double back) {
    const double last = 0.5 + back + (1.2 - 0.5 + back);
    motion().stations = {{0, {}, 0},
                         {0.5, {0.5, 0, 0}, 0},
                         {0.5 + back, {0.5 - back, 0, 0}, 0},
                         {last, {1.2, 0, 0}, 0}};
    scene.solver.end = last;
    forces.clear();
    work = 0;
    run();
  }
  double taken() const { return -energies.work("cutting"); }

  Scene scene = beam(host(), "tm-faure", 1, 1, 0, {{"E", 1e5}});
  std::unique_ptr<Simulation> simulation;
  std::vector<double> forces;  // N
  std::vector<double> lags;    // of a compliant handle, m
  double lag = 0;
  double work = 0;  // J, of the hand
  std::uint64_t cut = 0, divided = 0;
  EnergyBalance energies;
};

// A grid plane: the area of the faces is that of the blade's way, 0.8 x 0.2 m.
TEST_F(CuttingForce, IsToughnessTimesWidthAndItsWorkToughnessTimesArea) {
  run();
  EXPECT_EQ(cut, 16u * 4);
  EXPECT_NEAR(taken(), toughness * 0.16, 0.01 * toughness * 0.16);
  EXPECT_NEAR(work, energies.work("contact"), 1e-3 * work) << "the hand gives what contact gives";
  EXPECT_EQ(energies.work("friction"), 0);
  const std::size_t middle = forces.size() / 2;  // far from where it enters and leaves
  for (std::size_t i = middle - 20; i < middle + 20; ++i)
    EXPECT_NEAR(forces[i], toughness * 0.2, 0.05 * toughness * 0.2) << i;
}

// Off the planes of the grid, slanted and to no node's depth: stairs are cut, and what cutting
// takes is that of the way of the blade, 0.8 x 0.21 m.
TEST_F(CuttingForce, DoesNotDependOnTheElements) {
  blade().carried->points = {{-0.1, 0.21, 0.19}, {-0.25, 0.21, 0.6}};
  for (const Index n : {8, 12}) {
    scene.mesh.box->cells = {2 * n, n, n};
    forces.clear();
    work = 0;
    run();
    EXPECT_NEAR(taken(), toughness * 0.8 * 0.21, 0.02 * toughness * 0.8 * 0.21) << n;
  }
}

TEST_F(CuttingForce, TakesTheToughnessOfEachRegion) {
  CellValues::Part tough;
  tough.region.what = Selection::InBox{{-1, -1, -1}, {0.4, 1, 1}};
  tough.value = {2 * toughness};
  blade().resistance->toughness = values(toughness / 2);
  blade().resistance->toughness.parts = {tough};
  run();
  EXPECT_NEAR(taken(), toughness * 0.2, 0.01 * toughness * 0.2) << "(2 + 1/2) x 0.4 x 0.2 m^2";
}

// To 0.4 m, back by 0.2 m or out, and through: what is open takes nothing again.
TEST_F(CuttingForce, IsPaidOnceForEachPlace) {
  for (const double back : {0.2, 0.6}) {
    run_there_and_back(back);
    EXPECT_EQ(cut, 16u * 4);
    EXPECT_NEAR(taken(), toughness * 0.16, 0.02 * toughness * 0.16) << back;
    EXPECT_NEAR(work, energies.work("contact"), 2e-3 * work) << "nothing pulls it into the slit";
  }
}

// Ten times to and fro by less than an element.
TEST_F(CuttingForce, IsNotPaidAgainOnTheWayBack) {
  motion().stations = {{0, {}, 0}, {0.5, {0.5, 0, 0}, 0}};
  for (int i = 0; i < 20; ++i) {
    const double at = 0.54 + 0.04 * i;
    motion().stations.push_back({at, {i % 2 == 0 ? 0.48 : 0.5, 0, 0}, 0});
  }
  motion().stations.push_back({2, {1.2, 0, 0}, 0});
  scene.solver.end = 2;
  run();
  EXPECT_NEAR(taken(), toughness * 0.16, 0.02 * toughness * 0.16);
}

// The edge would have to press with 6000 N/m to begin. It takes the tissue along, and gives back
// what that has stored.
TEST_F(CuttingForce, ABladeThatIsTooWeakDeforms) {
  blade().resistance->stress = 6e6;
  blade().resistance->thickness = 1e-3;
  motion().stations = {{0, {}, 0}, {0.12, {0.12, 0, 0}, 0}};
  scene.solver.end = 0.5;
  run();
  EXPECT_EQ(cut, 0u);
  EXPECT_LT(taken(), 0.03 * work) << "the impact of the edge on the nodes that it meets";
  EXPECT_GT(forces.back(), 2 * toughness * 0.2) << "more than what it would take to go on";
  const Column& x = simulation->attributes().position();
  double farthest = 0;
  for (Index v = 0; v < x.size(); ++v)
    farthest = std::max(farthest, x.get(v, 0) - simulation->attributes().rest().get(v, 0));
  EXPECT_NEAR(farthest, 0.02, 0.002) << "as far as the edge has gone";
}

// The same edge goes on with less once it has begun.
TEST_F(CuttingForce, BeginsWithMoreThanItTakesToGoOn) {
  blade().resistance->stress = 6e5;
  blade().resistance->thickness = 1e-3;
  run();
  EXPECT_EQ(cut, 16u * 4);
  const double highest = *std::ranges::max_element(forces);
  EXPECT_GT(highest, 1.3 * toughness * 0.2);
  EXPECT_LT(highest, 600 * 0.2);
  EXPECT_NEAR(forces[forces.size() / 2], toughness * 0.2, 0.05 * toughness * 0.2);
}

/// The edge is slanted and lies in an oblique plane, from a depth of 0.19 m to the top.
class CuttingForceAlongTheBlade : public CuttingForce {
 protected:
  CuttingForceAlongTheBlade() {
    blade().along_blade = true;
    blade().carried->points = {{-0.1, 0.21, 0.19}, {-0.25, 0.3, 0.6}};
  }
  const double width = std::hypot(0.21, 0.21 / 0.41 * 0.09);
};

TEST_F(CuttingForceAlongTheBlade, TakesToughnessTimesArea) {
  for (const Index n : {8, 12}) {
    scene.mesh.box->cells = {2 * n, n, n};
    forces.clear();
    work = 0;
    run();
    EXPECT_GT(divided, 2 * n * (n / 2 - 1));
    EXPECT_NEAR(taken(), toughness * 0.8 * width, 0.02 * toughness * 0.8 * width) << n;
    EXPECT_NEAR(work, energies.work("contact"), 1e-3 * work);
    const std::size_t middle = forces.size() / 2;
    for (std::size_t i = middle - 20; i < middle + 20; ++i)
      EXPECT_NEAR(forces[i], toughness * width, 0.05 * toughness * width) << i;
  }
}

// To 0.4 m, back by 0.2 m or out, and through.
TEST_F(CuttingForceAlongTheBlade, IsPaidOnceForEachPlace) {
  for (const double back : {0.2, 0.6}) {
    run_there_and_back(back);
    EXPECT_NEAR(taken(), toughness * 0.8 * width, 0.02 * toughness * 0.8 * width) << back;
    EXPECT_NEAR(work, energies.work("contact"), 2e-3 * work) << "nothing pulls it into the slit";
  }
}

// A plane has cut the block before: two parts share each cube there, and one has the material.
TEST_F(CuttingForceAlongTheBlade, TakesWhatThePartsHave) {
  Event before;
  before.path = "/events/1";
  before.what = CutPlane{.point = {0.41, 0, 0}, .normal = {1, 0.1, 0.2}, .along_blade = true};
  scene.events.push_back(before);
  run();
  EXPECT_NEAR(taken(), toughness * 0.8 * width, 0.02 * toughness * 0.8 * width);
}

// A handle of 0.5 kg on springs of 60 N / 0.02 m and more: it lags behind the hand by F / k, and
// the hand feels and gives what cutting takes.
class CuttingForceOnASpring : public CuttingForce {
 protected:
  static constexpr double mass = 0.5;  // kg
  void couple(double stiffness) {
    constexpr double inertia = 1;
    const double turning = 100 * stiffness;  // the edge is 2.8 m below the handle
    scene.contact.obstacles[0].coupling =
        Coupling{mass,    stiffness, 2 * std::sqrt(mass * stiffness),
                 inertia, turning,   2 * std::sqrt(inertia * turning)};
    scene.contact.obstacles[0].motion.centre = {0, 0.2, 3};
    forces.clear();
    lags.clear();
    work = 0;
    run();
  }
  double force() const { return mean(forces); }
  /// Takes the steps in which the edge is far from where it enters and leaves.
  static double mean(const std::vector<double>& values) {
    const auto first = values.begin() + std::ptrdiff_t(values.size() * 2 / 5);
    const auto last = values.begin() + std::ptrdiff_t(values.size() * 3 / 5);
    return std::accumulate(first, last, 0.0) / static_cast<double>(last - first);
  }
};

TEST_F(CuttingForceOnASpring, StretchesIt) {
  for (const double stiffness : {3e3, 3e4}) {
    couple(stiffness);
    EXPECT_EQ(cut, 16u * 4);
    EXPECT_NEAR(taken(), toughness * 0.16, 0.01 * toughness * 0.16) << stiffness;
    EXPECT_NEAR(force(), toughness * 0.2, 0.01 * toughness * 0.2) << stiffness;
    EXPECT_NEAR(mean(lags), toughness * 0.2 / stiffness, 0.01 * toughness * 0.2 / stiffness);
    // The hand starts at 1 m/s at once; the spring is stretched and released.
    const double start = mass, stored = std::pow(toughness * 0.2, 2) / stiffness;
    EXPECT_GT(work, energies.work("contact") + 0.9 * start);
    EXPECT_LT(work, energies.work("contact") + 2 * (start + stored));
  }
}

TEST_F(CuttingForceOnASpring, IsThatOfItsPathIfTheSpringIsStiff) {
  scene.solver.end = 0.6;
  run();
  const double prescribed = taken(), driven = work;
  const std::vector<double> with_path = forces;
  couple(1e9);
  EXPECT_NEAR(taken(), prescribed, 1e-3 * prescribed);
  EXPECT_NEAR(work, driven + mass, 1e-3 * driven) << "m v^2, of a hand that starts at 1 m/s";
  EXPECT_NEAR(mean(forces), mean(with_path), 1e-3 * mean(forces));
  EXPECT_LT(mean(lags), 1e-6);
}

TEST_F(CuttingForce, HasTheSameBitsForAnyNumberOfThreads) {
  scene.solver.end = 0.4;
  for (const bool along : {false, true}) {
    blade().along_blade = along;
    if (along) scene.contact.obstacles[0].coupling = Coupling{0.5, 3e4, 200, 1, 3e6, 3e3};
    std::vector<double> first;
    for (const unsigned threads : thread_counts()) {
      scene.solver.threads = threads;
      forces.clear();
      run();
      EXPECT_GT(taken(), 1);
      if (first.empty()) first = forces;
      EXPECT_EQ(forces, first) << threads << " threads";
    }
  }
}

TEST_F(CuttingForce, NeedsATableThatCoversTheBody) {
  blade().resistance->toughness.elsewhere.clear();
  CellValues::Part part;
  part.region.what = Selection::InBox{{-1, -1, -1}, {0.4, 1, 1}};
  part.value = {1};
  blade().resistance->toughness.parts = {part};
  try {
    run();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              "/events/0/cut/blade/resistance/toughness: has no value for element 8; add "
              "\"elsewhere\"");
  }
}

}  // namespace
}  // namespace suture::test
