// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cuts in a running simulation: what must change, what must not, and bitwise identical results for
// any number of threads.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/base/sanitizer.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/events.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

Event cut_at(double time, const Vec3& point, const Vec3& normal) {
  return event_of(CutPlane{point, normal}, time);
}

std::vector<double> rows(const Column& column) {
  const std::size_t count = std::size_t{column.size()} * static_cast<std::size_t>(column.stride());
  return {column.rows(), column.rows() + count};
}

// Mass, momentum and the position of every corner of every element.
struct Snapshot {
  double mass = 0;
  Vec3 momentum{};
  std::vector<double> corners;

  explicit Snapshot(Simulation& simulation) {
    Attributes& a = simulation.attributes();
    for (Index v = 0; v < a.vertex_count(); ++v) {
      mass += a.mass().get(v, 0);
      for (int c = 0; c < 3; ++c) {
        momentum[static_cast<std::size_t>(c)] += a.mass().get(v, 0) * a.velocity().get(v, c);
      }
    }
    for (const Hexahedron& nodes : simulation.complex().vertices()) {
      for (const Index v : nodes) {
        for (int c = 0; c < 3; ++c) corners.push_back(a.position().get(v, c));
      }
    }
  }
};

class BothModels : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Cut, BothModels, testing::Values("tm-faure", "mss-baudet"),
                         [](const auto& test) { return std::string(test.param, 2); });

TEST_P(BothModels, ACutWhileItMovesKeepsMassMomentumAndEveryCorner) {
  Scene scene = beam(host(), GetParam(), 20, 5, 0.98);
  scene.solver.integrator = "velocity-verlet";
  scene.solver.dt = 2e-4;
  scene.solver.end = 0.1;
  TestSimulation simulation(scene);
  simulation.run_to(0.05);
  simulation.energies();  // makes the velocities those of the positions
  const Snapshot before(simulation);
  const std::size_t vertices = simulation.complex().count(0);
  simulation.apply(cut_at(0.05, {0.5, 0, 0}, {1, 0.2, 0}));
  const Snapshot after(simulation);
  EXPECT_GT(simulation.complex().count(0), vertices) << "something was cut";
  Index islands = 0;
  simulation.complex().islands(&islands);
  EXPECT_EQ(islands, 2u);
  simulation.complex().validate();
  EXPECT_NEAR(after.mass, before.mass, 1e-13 * before.mass);
  EXPECT_GT(std::abs(before.momentum[1]), 0.1) << "kg m/s; it was moving";
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(after.momentum[c], before.momentum[c], 1e-13 * std::abs(before.momentum[1]));
  }
  EXPECT_EQ(after.corners, before.corners);
}

// A piece that hangs on nothing falls freely: its centre of mass follows g t^2/2.
TEST_P(BothModels, APieceCutOffFallsFreely) {
  Scene scene = beam(host(), GetParam(), 8, 2, 9.8);
  scene.solver.integrator = "velocity-verlet";
  scene.solver.dt = 2e-4;
  scene.solver.end = 0.3;
  scene.events.push_back(cut_at(0, {0.5, 0, 0}, {1, 0, 0}));
  TestSimulation simulation(scene);
  simulation.run_to(0.3);
  Attributes& a = simulation.attributes();
  double mass = 0, drop = 0;
  std::vector<char> seen(a.vertex_count());
  for (const Hexahedron& nodes : simulation.complex().vertices()) {
    for (const Index v : nodes) {
      const bool right = a.rest().get(nodes[0], 0) > 0.5 - 1e-9;
      if (!right || seen[v]) continue;
      seen[v] = 1;
      mass += a.mass().get(v, 0);
      drop += a.mass().get(v, 0) * (a.position().get(v, 1) - a.rest().get(v, 1));
    }
  }
  EXPECT_NEAR(mass, 0.5 * 0.25 * 0.25 * 1000, 1e-9);
  EXPECT_NEAR(drop / mass, -9.8 * 0.3 * 0.3 / 2, 1e-10);
}

TEST_P(BothModels, TheSameBitsForAnyNumberOfThreads) {
  std::vector<double> expected;
  for (const unsigned threads : thread_counts()) {
    Scene scene = beam(host(), GetParam(), 48, 12, 9.8);
    scene.solver.threads = threads;
    scene.solver.dt = 1e-4;
    scene.solver.end = 0.002;
    scene.events.push_back(cut_at(0.001, {0.5, 0.1, 0}, {1, 1, 0.3}));
    TestSimulation simulation(scene);
    simulation.run();
    const std::vector<double> positions = rows(simulation.attributes().position());
    if (expected.empty()) expected = positions;
    ASSERT_EQ(positions.size(), expected.size());
    EXPECT_EQ(std::memcmp(positions.data(), expected.data(), 8 * expected.size()), 0)
        << threads << " threads";
  }
}

// The same model on two halves is one body: springs of the seam are summed from
// both sides, masses too.
TEST_P(BothModels, TwoEqualInstancesBehaveAsOne) {
  std::vector<double> one;
  for (const bool split : {false, true}) {
    Scene scene = beam(host(), GetParam(), 12, 4, 0.98);
    if (split) {
      scene.models.push_back(scene.models[0]);
      scene.models[0].region.what = Selection::HalfSpace{{0.5, 0, 0}, {-1, 0, 0}};
      scene.models[1].region.what = Selection::HalfSpace{{0.5, 0, 0}, {1, 0, 0}};
      scene.models[1].name = "other";
    }
    scene.solver.dt = 1e-4;
    scene.solver.end = 0.1;
    TestSimulation simulation(scene);
    simulation.run();
    const std::vector<double> positions = rows(simulation.attributes().position());
    if (!split) one = positions;
    double worst = 0;
    for (std::size_t i = 0; i < one.size(); ++i) {
      worst = std::max(worst, std::abs(positions[i] - one[i]));
    }
    EXPECT_LT(worst, 1e-13) << "m";
  }
}

// 4 x 4 x 4 = 64 loose elements, each of which falls like a stone.
TEST_P(BothModels, ACutCanLeaveSingleElements) {
  Scene scene = beam(host(), GetParam(), 4, 4, 9.8);
  scene.mesh.box->size = {1, 1, 1};
  scene.constraints.clear();
  scene.solver.dt = 1e-4;
  scene.solver.end = 0.01;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 1; i < 4; ++i) {
      Vec3 point{}, normal{};
      point[static_cast<std::size_t>(axis)] = 0.25 * i;
      normal[static_cast<std::size_t>(axis)] = 1;
      scene.events.push_back(cut_at(0, point, normal));
    }
  }
  TestSimulation simulation(scene);
  const RunSummary summary = simulation.run();
  EXPECT_EQ(summary.faces_cut, 3u * 3 * 16);
  EXPECT_EQ(simulation.complex().count(0), 8u * 64);
  double mass = 0;
  for (Index v = 0; v < 8 * 64; ++v) mass += simulation.attributes().mass().get(v, 0);
  EXPECT_NEAR(mass, 1000, 1e-10);
  // x after n steps of symplectic Euler from rest: g dt^2 n (n + 1) / 2
  const double fall = -9.8 * 1e-8 * 100 * 101 / 2;
  for (Index v = 0; v < 8 * 64; ++v) {
    Attributes& a = simulation.attributes();
    EXPECT_NEAR(a.position().get(v, 1) - a.rest().get(v, 1), fall, 1e-12);
  }
}

TEST(Cut, ThatMissesWarnsAndChangesNothing) {
  Scene scene = beam(host(), "tm-faure", 4, 1, 9.8);
  scene.solver.dt = 1e-4;
  scene.solver.end = 1e-3;
  scene.events.push_back(cut_at(5e-4, {7, 0, 0}, {1, 0, 0}));
  TestSimulation simulation(scene);
  EXPECT_EQ(simulation.run().faces_cut, 0u);
  ASSERT_EQ(simulation.diagnostics.warnings().size(), 1u);
  EXPECT_NE(simulation.diagnostics.warnings()[0].find("cut no face"), std::string::npos);
}

}  // namespace
}  // namespace suture::test
