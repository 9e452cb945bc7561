// SPDX-License-Identifier: GPL-3.0-or-later
//
// Nodes that are held and let go while a body moves.
#include <gtest/gtest.h>

#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/operations/event_runner.hpp"
#include "tests/run/beam.hpp"

namespace suture::test {
namespace {

Grasp grasp_of(Selection::InBox box, Vec3 translation = {}, double duration = 0) {
  Grasp grasp;
  grasp.held.name = "clamp";
  grasp.held.where.what = box;
  grasp.held.moves = duration > 0;
  grasp.held.translation = translation;
  grasp.held.ramp.to = duration;
  return grasp;
}

constexpr Selection::InBox far_end{{0.95, -1, -1}, {9, 1, 1}};

/// A beam of 8 x 2 x 2 elements of 0.125 m that is held at x = 0.
class Grasps : public testing::Test {
 protected:
  void build(const char* integrator = "symplectic-euler") {
    scene.solver.integrator = integrator;
    scene.constraints[0].name = "wall";
    built = std::make_unique<BuiltScene>(scene, diagnostics);
    built->dynamics().start();
    runner = std::make_unique<EventRunner>(scene, *built, diagnostics);
    built->dynamics().balance();
  }
  EventOutcome apply(EventOperation what) {
    Event event;
    event.what = std::move(what);
    event.path = "/now";
    return runner->apply(event, built->dynamics().time());
  }
  std::string refusal(EventOperation what) {
    try {
      apply(std::move(what));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  void steps(int count, double dt) {
    Dynamics& dynamics = built->dynamics();
    for (int i = 0; i < count; ++i) dynamics.step(dt, dynamics.time() + dt);
  }
  double displacement(Index v) {
    return attributes().position().get(v, 0) - attributes().rest().get(v, 0);
  }
  Attributes& attributes() { return built->body().attributes(); }
  std::vector<Constraints::Held> held() { return built->body().constraints().held_by("clamp"); }

  Scene scene = beam(tree_plugins(), "tm-faure", 8, 2, 0);
  Diagnostics diagnostics;
  std::unique_ptr<BuiltScene> built;
  std::unique_ptr<EventRunner> runner;
};

class EachScheme : public Grasps, public testing::WithParamInterface<const char*> {};

TEST_P(EachScheme, GraspsMoveTheirNodesFromWhereTheyAre) {
  build(GetParam());
  Column& x = attributes().position();
  for (Index v = 0; v < x.size(); ++v) x.set(v, 0, 1.02 * x.get(v, 0));
  steps(3, 1e-4);
  const Column before = x;
  EXPECT_EQ(apply(grasp_of(far_end, {0.001, 0, 0}, 2e-3)).text(), "grasped 9 nodes");
  steps(10, 1e-4);
  for (const auto& [v, components] : held())
    EXPECT_NEAR(x.get(v, 0), before.get(v, 0) + 0.0005, 1e-12);
  EXPECT_EQ(apply(Release{"clamp"}).text(), "released 9 nodes");
  EXPECT_TRUE(held().empty());
  EXPECT_EQ(attributes().fixed().get(attributes().vertex_count() - 1, 0), 0);
  EXPECT_NE(refusal(Release{"clamp"}).find("nothing named 'clamp' holds a node"),
            std::string::npos);
}

/// All nodes move at 2 m/s when the constraint that drives them is released: they fly on.
TEST_P(EachScheme, ReleasedNodesKeepTheirVelocity) {
  scene.constraints[0].where.what = Selection::All{};
  scene.constraints[0].moves = true;
  scene.constraints[0].translation = {0.02, 0, 0};
  scene.constraints[0].ramp.to = 0.01;
  build(GetParam());
  steps(20, 1e-4);
  EXPECT_EQ(apply(Release{"wall"}).nodes_released, attributes().vertex_count());
  steps(20, 1e-4);
  for (Index v = 0; v < attributes().vertex_count(); ++v)
    EXPECT_NEAR(displacement(v), 0.008, 1e-9) << v;
}

/// From rest, x = a t^2 / 2 in the first step, whatever the times of the velocities.
TEST_P(EachScheme, ReleasedNodesStartAsTheForcesSay) {
  build(GetParam());
  apply(grasp_of(far_end, {0.02, 0, 0}, 1e-3));
  steps(30, 1e-4);
  const auto clamped = held();
  const Index v = clamped[4].vertex;
  const double before = displacement(v);
  const double force = built->body().forces_at({&v, 1}, built->dynamics().time())[0][0];
  const double a = force / attributes().mass().get(v, 0);
  EXPECT_LT(a, -100);
  apply(Release{"clamp"});
  steps(1, 1e-4);
  EXPECT_NEAR(displacement(v) - before, a * 1e-8 / 2, 0.05 * std::abs(a) * 1e-8 / 2);
}

/// A stretched beam is let go: its energy, with that of the jump, is conserved to second order.
TEST_P(EachScheme, TheLedgerCloses) {
  build(GetParam());
  apply(grasp_of(far_end, {0.05, 0, 0}, 5e-3));
  steps(100, 5e-5);
  const EnergyBalance pulled = built->dynamics().balance();
  EXPECT_GT(pulled.prescribed, 1);
  EXPECT_LT(std::abs(pulled.balance), 0.02 * pulled.exchanged);
  apply(Release{"clamp"});
  steps(100, 5e-5);
  const EnergyBalance free = built->dynamics().balance();
  EXPECT_NEAR(free.prescribed, pulled.prescribed, 0.02 * pulled.prescribed);
  EXPECT_LT(std::abs(free.balance), 0.02 * free.exchanged);
  EXPECT_GT(free.kinetic, 0.01 * free.exchanged);
}

INSTANTIATE_TEST_SUITE_P(All, EachScheme,
                         testing::Values("symplectic-euler", "velocity-verlet", "newmark"));

TEST_F(Grasps, LeaveWhatIsHeldToItsConstraint) {
  scene.constraints[0].components = 1;
  build();
  apply(grasp_of({{-1, -1, -1}, {9, 1, 1}}, {0.01, 0.01, 0}, 1e-3));
  steps(20, 1e-4);
  const double* x = attributes().position().rows();
  EXPECT_EQ(x[0], 0);
  EXPECT_NEAR(x[1] - attributes().rest().get(0, 1), 0.01, 1e-12);
  apply(Release{"clamp"});
  EXPECT_EQ(attributes().fixed().get(0, 0), 1);
}

TEST_F(Grasps, CutsKeepBothCopiesHeld) {
  build();
  apply(grasp_of(far_end, {0.01, 0, 0}, 1e-3));
  steps(5, 1e-4);
  apply(CutPlane{{0, 0.125, 0}, {0, 1, 0}});
  EXPECT_EQ(held().size(), 12u) << "three more";
  steps(15, 1e-4);
  for (const auto& [v, components] : held()) EXPECT_NEAR(displacement(v), 0.01, 1e-12);
}

/// A wall that touches the far end turns and draws back, and is then steered elsewhere.
TEST_F(Grasps, WhatAnObstacleTouchesMovesWithIt) {
  Obstacle wall{"jaw", "/contact/obstacles/0", HalfSpace{{1, 0, 0}, {-1, 0, 0}}};
  wall.motion = {{{0, {}, 0}, {1e-3, {0.01, 0, 0}, 0.2}}, {1, 0, 0}, {1, 0.1, 0.1}};
  scene.contact.obstacles = {wall};
  build();
  ContactLaw& contact = *built->body().contact();
  steps(2, 1e-4);
  Grasp grasp = grasp_of(far_end);
  grasp.obstacle = 0;
  grasp.reach = 0.01;
  const Column start = attributes().position();
  const double time = built->dynamics().time();
  const Pose then = contact.pose(0, time);
  EXPECT_EQ(apply(grasp).nodes_held, 9u);
  const auto expect_carried = [&] {
    const Pose now = contact.pose(0, built->dynamics().time());
    for (const auto& [v, components] : held()) {
      const Vec3 place = now.place(then.given({start.get(v, 0), start.get(v, 1), start.get(v, 2)}));
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(attributes().position().get(v, c), place[static_cast<std::size_t>(c)], 1e-12);
    }
  };
  steps(5, 1e-4);
  expect_carried();
  contact.set_path(0, contact.obstacles()[0].motion.steered(
                          built->dynamics().time(), {2e-3, Vec3{0.02, 0.01, 0}, Vec3{0, 0.1, 0}}));
  built->redirect(0);
  steps(5, 1e-4);
  expect_carried();
  EXPECT_GT(norm(contact.pose(0, built->dynamics().time()).translation), 0.007);
}

TEST_F(Grasps, OfNothingAreRefused) {
  build();
  EXPECT_NE(refusal(grasp_of({{5, 5, 5}, {6, 6, 6}}))
                .find("/now/grasp/where: selects no node of the deformed body"),
            std::string::npos);
  EXPECT_NE(refusal(grasp_of({{-1, -1, -1}, {0.01, 1, 1}})).find("hold already"),
            std::string::npos);
  EXPECT_EQ(apply(grasp_of(far_end)).nodes_held, 9u);
  EXPECT_NE(refusal(grasp_of(far_end)).find("'clamp' holds nodes already"), std::string::npos);
  EXPECT_NE(refusal(Release{"wal"}).find("did you mean 'wall'"), std::string::npos);
}

}  // namespace
}  // namespace suture::test
