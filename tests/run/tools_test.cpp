// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tools in complete runs: blades that obstacles carry, compliant tools, obstacles of triangles.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "kernel/forces/contact_law.hpp"
#include "kernel/geometry/solid_surface.hpp"
#include "tests/base/sanitizer.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/csv_table.hpp"
#include "tests/run/events.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test::tools_test {
namespace {

constexpr double dt = 1e-3;

/// A block of 0.8 x 0.4 x 0.4 m, held at the bottom, cut for 0.2 s by what `blade` says, while an
/// obstacle moves far above it.
Scene cut_block(CutBlade blade, const RigidPath& motion) {
  Scene scene = beam(host(), "tm-faure", 1, 1, 0, {{"E", 1e5}});
  scene.mesh.box = BoxOptions{{0, 0, 0}, {0.8, 0.4, 0.4}, {8, 4, 4}, {1, 1, 1}};
  scene.constraints[0].where.what = Selection::Named{"z0"};
  Obstacle obstacle{"knife", "/contact/obstacles/0", Sphere{{0, 0.2, 3}, 0.1}, motion};
  scene.contact.obstacles = {obstacle};
  scene.solver.dt = dt;
  scene.solver.end = 0.2;
  scene.events = {event_of(std::move(blade))};
  return scene;
}

struct Result {
  std::uint64_t faces = 0;
  std::vector<double> state;
};

Result run(const Scene& scene) {
  TestSimulation simulation(scene);
  const RunSummary summary = simulation.run();
  const Column& x = simulation.attributes().position();
  return {summary.faces_cut, {x.rows(), x.rows() + 4 * std::size_t{x.size()}}};
}

CutBlade carried(const std::vector<Vec3>& points) {
  CutBlade blade;
  blade.carried = CutBlade::Carried{0, "knife", points};
  return blade;
}

TEST(Tools, ACarriedBladeCutsAsOneWithTheSamePath) {
  const std::vector<Vec3> points{{-0.1, 0.21, 0.22}, {-0.1, 0.21, 0.6}};
  RigidPath motion;
  motion.stations = {{0.05, {}, 0}, {0.2, {0.6, -0.02, 0.01}, 0}};
  CutBlade path;
  path.stations = {{0, points}, {0.05, points}, {0.2, points}};
  for (Vec3& p : path.stations.back().points) {
    p[0] += 0.6;
    p[1] -= 0.02;
    p[2] += 0.01;
  }
  const Result own = run(cut_block(path, motion)), with = run(cut_block(carried(points), motion));
  EXPECT_EQ(own.faces, 2u * 5);
  EXPECT_EQ(with.faces, own.faces);
  EXPECT_EQ(with.state, own.state) << "the same faces in the same steps";
}

// A blade that turns about an axis along y cuts an arc, as a path with a station in every step.
TEST(Tools, ACarriedBladeTurnsWithItsObstacle) {
  const std::vector<Vec3> points{{0.02, 0.21, 0.95}, {0.32, 0.21, 0.95}};
  RigidPath motion;
  motion.stations = {{0, {}, 0}, {0.2, {}, 1.2}};
  motion.axis = {0, 1, 0};
  motion.centre = {0, 0.2, 0.95};
  CutBlade path;
  for (int i = 0; i <= 200; ++i) {
    const Pose pose = motion.pose(i * dt);
    path.stations.push_back({i * dt, {pose.place(points[0]), pose.place(points[1])}});
  }
  const Result own = run(cut_block(path, motion)), with = run(cut_block(carried(points), motion));
  EXPECT_EQ(own.faces, 0u) << "still above the block";
  EXPECT_EQ(with.faces, 0u);
  std::vector<Vec3> longer{{0.02, 0.21, 0.95}, {0.82, 0.21, 0.95}};
  for (int i = 0; i <= 200; ++i) path.stations[i].points[1] = motion.pose(i * dt).place(longer[1]);
  const Result deep = run(cut_block(path, motion)),
               turned = run(cut_block(carried(longer), motion));
  EXPECT_GT(deep.faces, 3u);
  EXPECT_EQ(turned.faces, deep.faces);
}

/// The block of cut_block, with a compliant ball that presses it and a carried blade.
Scene pressed_block() {
  Scene scene = cut_block(carried({{-0.1, 0.21, 0.22}, {-0.1, 0.21, 0.6}}), {});
  Obstacle& ball = scene.contact.obstacles[0];
  ball.shape = Sphere{{0.2, 0.2, 0.51}, 0.1};
  ball.friction = 0.2;
  ball.motion.centre = {0.2, 0.2, 0.51};
  ball.motion.stations = {{0, {}, 0}, {0.2, {0.5, 0, -0.06}, 0.3}};
  ball.coupling = Coupling{2, 2e4, 200, 0.01, 100, 1};
  scene.contact.pieces = true;
  return scene;
}

TEST(Tools, WriteWhatTheHandFeelsAndWhereTheToolIs) {
  const TemporaryFolder folder;
  Scene scene = pressed_block();
  scene.output.enabled = true;
  scene.output.directory = folder.path() / "out";
  scene.output.frames = false;
  scene.output.tools_every = 1;
  TestSimulation simulation(scene);
  simulation.run();
  const CsvTable tools(folder.path() / "out" / "tools.csv");
  ASSERT_EQ(tools.columns.size(), 2u + 6 * 3);
  const auto tool = *simulation.contact()->tool_state(0);
  EXPECT_EQ(tools.last("knife force z [N]"), simulation.contact()->loads()[0].force[2]);
  EXPECT_EQ(tools.last("knife hand force z [N]"), tool.hand_force[2]);
  EXPECT_EQ(tools.last("knife hand torque y [N m]"), tool.hand_torque[1]);
  EXPECT_NEAR(tools.last("knife position x [m]"), 0.2 + tool.pose.translation[0], 1e-15);
  EXPECT_GT(tools.last("knife position x [m]"), 0.5);
  EXPECT_EQ(tools.last("knife rotation z [rad]"), rotation_vector(tool.pose)[2]);
  EXPECT_GT(tools.last("knife force z [N]"), 1);
}

TEST(Tools, HaveTheSameBitsForAnyNumberOfThreads) {
  std::vector<double> first;
  for (const unsigned threads : thread_counts()) {
    Scene scene = pressed_block();
    scene.mesh.box->cells = {24, 18, 18};  // enough vertices for parallel passes
    scene.solver.dt = {};
    scene.solver.end = 0.05;
    scene.contact.obstacles[0].motion.stations.back() = {0.05, {0.16, 0, -0.02}, 0.05};
    scene.solver.threads = threads;
    TestSimulation simulation(scene);
    const RunSummary summary = simulation.run();
    EXPECT_GT(summary.faces_cut, 0u);
    const Column& x = simulation.attributes().position();
    std::vector<double> all(x.rows(), x.rows() + 4 * std::size_t{x.size()});
    const Vec3 force = simulation.contact()->tool_state(0)->hand_force;
    all.insert(all.end(), force.begin(), force.end());
    EXPECT_NE(all.back(), 0);
    if (threads == 1) first = all;
    EXPECT_EQ(all, first) << threads << " threads";
  }
}

}  // namespace
}  // namespace suture::test::tools_test
