// SPDX-License-Identifier: GPL-3.0-or-later
//
// Compliant tools: the coupling by itself, momentum, passivity and states with contact.
#include "kernel/contact/tool.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "kernel/base/rows.hpp"
#include "kernel/contact/contact.hpp"
#include "tests/dynamics/model_block.hpp"

namespace suture::tool_test {
namespace {

/// A ball of 2 kg and 50 N/m, w = 5 / s, whose hand goes as `stations` say.
Obstacle ball(std::vector<RigidPath::Station> stations) {
  Obstacle tool{"ball", "/contact/obstacles/0", Sphere{{0.5, 0.5, 2}, 1}};
  tool.motion.stations = std::move(stations);
  tool.motion.centre = {0.5, 0.5, 2};
  tool.coupling = Coupling{2, 50, 20, 0.5, 12.5, 5};
  return tool;
}

Vec3 shift(const Tool& tool) { return tool.pose().translation; }

/// The tool after `time` in steps of dt, alone.
Tool moved(const Obstacle& obstacle, double time, double dt) {
  Tool tool(obstacle);
  for (int i = 0; i < std::lround(time / dt); ++i) {
    tool.begin(obstacle.motion, i * dt, (i + 1) * dt, dt, dt);
    tool.finish({});
  }
  return tool;
}

// Critically damped, from rest, to a hand that has suddenly gone by 1: 1 - (1 + w t) exp(-w t),
// also in rotation; the error is of first order in dt.
TEST(Tool, FollowsTheHandAsADampedSpring) {
  const double w = 5, time = 0.3, expected = 1 - (1 + w * time) * std::exp(-w * time);
  double errors[2], turns[2];
  for (const int i : {0, 1}) {
    const double dt = 1e-4 / (1 + i);
    Obstacle obstacle = ball({{0, {}, 0}, {0.1 * dt, {1, 0, 0}, 1}});
    // Without the kick of a damper that sees the hand jump.
    obstacle.motion.stations = {{-1, {1, 0, 0}, 1}};
    Obstacle at_rest = obstacle;
    at_rest.motion.stations = {{0, {}, 0}};
    Tool tool(at_rest);
    for (int step = 0; step < std::lround(time / dt); ++step) {
      tool.begin(obstacle.motion, step * dt, (step + 1) * dt, dt, dt);
      tool.finish({});
    }
    errors[i] = shift(tool)[0] - expected;
    turns[i] = rotation_vector(tool.pose())[2] - expected;
  }
  EXPECT_NEAR(errors[0] / errors[1], 2, 0.01);
  EXPECT_NEAR(turns[0] / turns[1], 2, 0.01);
  EXPECT_LT(std::abs(errors[1]), 1e-4);
  EXPECT_LT(std::abs(turns[1]), 1e-4);
}

TEST(Tool, DoesNotLagBehindAHandOfConstantSpeed) {
  const Tool tool = moved(ball({{0, {}, 0}, {10, {5, -2, 1}, 4}}), 8, 1e-3);
  EXPECT_NEAR(shift(tool)[0], 4, 1e-9);
  EXPECT_NEAR(shift(tool)[1], -1.6, 1e-9);
  EXPECT_NEAR(tool.spin()[2], 0.4, 1e-9);
  EXPECT_NEAR(norm(tool.hand_force()), 0, 1e-9);
  EXPECT_NEAR(rotation_vector(tool.pose())[2], 3.2 - 2 * std::acos(-1.), 1e-9) << "beyond pi";
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(norm(tool.pose().turn[i]), 1, 1e-14);
}

/// A block under a compliant ball that the hand pushes down and sideways.
struct Pressed : rig::Block {
  explicit Pressed(const Obstacle& tool, const char* scheme = rig::euler, bool held = true)
      : Block("tm-faure", {{"E", 4e5}, {"nu", 0.3}, {"rho", 1000}}, {3, 3, 3}, 1. / 3,
              {scheme, 0, {}, {}}),
        contact(body.add_contact({tool}, 0)) {
    if (held) hold(vertices([](const Vec3& x) { return x[2] < 1e-9; }), 7);
    start();
  }
  const Tool& tool() const { return *contact.tool(0); }
  Contact& contact;
};

Obstacle presser(double friction = 0.3) {
  Obstacle tool = ball({{0, {}, 0}, {0.05, {0.02, 0, -0.12}, 0.5}});
  tool.friction = friction;
  tool.coupling = Coupling{20, 5e4, 2000, 0.5, 1000, 45};
  return tool;
}

class ToolSchemes : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Tool, ToolSchemes, testing::ValuesIn(rig::schemes), [](const auto& test) {
  return std::string(test.param, 6) == "veloci" ? "verlet" : "euler";
});

/// A step in which the body feels what the tool feels, and the momentum of the tool changes by what
/// body and hand give it. Returns the force of the body, N, and its torque, N m.
std::array<double, 2> expect_reaction(Pressed& pressed, double dt) {
  const Vec3 before = pressed.tool().velocity(), spin = pressed.tool().spin();
  pressed.run(dt, 1);
  const Tool& tool = pressed.tool();
  const Contact::Load& load = pressed.contact.loads()[0];
  Vec3 vertices{};
  for (const Contact::Touch& touch : pressed.contact.touches())
    vertices = plus(vertices, touch.force);
  const double scale = 1 + norm(load.force) + norm(tool.hand_force());
  const Vec3 change = scaled(20 / dt, minus(tool.velocity(), before));
  const Vec3 turning = scaled(0.5 / dt, minus(tool.spin(), spin));
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(vertices[c], -load.force[c], 1e-12 * scale);
    EXPECT_NEAR(change[c], load.force[c] - tool.hand_force()[c], 1e-10 * scale) << "differences";
    EXPECT_NEAR(turning[c], load.torque[c] - tool.hand_torque()[c], 1e-10 * scale);
  }
  return {norm(load.force), norm(load.torque)};
}

TEST_P(ToolSchemes, ActionEqualsReactionInEveryStep) {
  Pressed pressed(presser(), GetParam());
  const double dt = 0.5 * pressed.stable_step();
  pressed.run(dt, 1);  // a first kick may be shorter
  double largest = 0, torque = 0;
  for (int i = 0; i < 400; ++i) {
    const auto [force, turning] = expect_reaction(pressed, dt);
    largest = std::max(largest, force);
    torque = std::max(torque, turning);
  }
  EXPECT_GT(largest, 500);
  EXPECT_GT(torque, 5);
}

TEST_P(ToolSchemes, NothingEntersTheTool) {
  Pressed pressed(presser(), GetParam());
  const double dt = 0.5 * pressed.stable_step();
  int touching = 0;
  for (int i = 0; i < 400; ++i) {
    pressed.run(dt, 1);
    touching += !pressed.contact.touches().empty();
    for (const double gap : pressed.contact.gaps(pressed.dynamics.time()))
      if (!std::isnan(gap)) {
        ASSERT_GT(gap, -1e-9) << "step " << i;
      }
  }
  EXPECT_GT(touching, 100);
}

// In balance, the hand feels what the body feels, and the spring is stretched by it.
TEST(Tool, TheHandFeelsTheForceOfContact) {
  Obstacle tool = presser();
  tool.motion.stations.back() = {0.2, {0, 0, -0.1}, 0};
  Pressed pressed(tool);
  pressed.dynamics.motion().set_damping(20);
  const double dt = 0.5 * pressed.stable_step();
  pressed.run(dt, static_cast<int>(2 / dt));
  const Vec3 &felt = pressed.tool().hand_force(), &load = pressed.contact.loads()[0].force;
  EXPECT_GT(load[2], 500);
  EXPECT_NEAR(felt[2], load[2], 1e-3 * load[2]);
  EXPECT_NEAR(felt[2], 5e4 * (shift(pressed.tool())[2] + 0.1), 1e-3 * load[2]);
}

/// A blade beside the ball, in the middle of the block; 500 J/m^2.
constexpr double edge_toughness = 500;
CuttingEdges::Edge edge_in_the_block() {
  return {0, {{0.3, 0.5, 0.45}, {0.7, 0.5, 0.55}}, std::vector<double>(27, edge_toughness)};
}

// By itself, and beside the push of the ball; with pieces, whose touches are found again for each
// motion of the tool. The edge takes the tissue along, and then cuts.
TEST_P(ToolSchemes, WhatResistsABladeIsPartOfTheReaction) {
  for (const auto& [pushes, has_pieces] : {std::pair(false, false), {true, false}, {true, true}}) {
    Obstacle obstacle = presser();
    obstacle.pushes = pushes;
    Pressed pressed(obstacle, GetParam());
    if (has_pieces) pressed.contact.touch_pieces({});
    pressed.contact.add_edge(edge_in_the_block());
    const double dt = 0.5 * pressed.stable_step(), length = std::hypot(0.4, 0.1);
    pressed.run(dt, 1);  // a first kick may be shorter
    double largest = 0, torque = 0;
    int holding = 0, cutting = 0;
    for (int i = 0; i < 400; ++i) {
      const double taken = -*pressed.contact.cutting_work();
      const auto [force, turning] = expect_reaction(pressed, dt);
      largest = std::max(largest, force);
      torque = std::max(torque, turning);
      const bool cuts = -*pressed.contact.cutting_work() > taken + 1e-9;
      (cuts ? cutting : holding) += force > 1;
    }
    EXPECT_GT(holding, 5) << pushes;
    EXPECT_GT(cutting, 5) << pushes;
    EXPECT_GT(torque, 5) << pushes;
    if (pushes)
      EXPECT_GT(largest, 1.2 * edge_toughness * length);
    else
      EXPECT_NEAR(largest, edge_toughness * length, 0.05 * edge_toughness * length);
  }
}

double energy(Pressed& pressed, const Coupling& c, const Obstacle& obstacle) {
  const Tool& tool = pressed.tool();
  const Energies body = energies(pressed.dynamics);
  const Vec3 stretch = minus(obstacle.motion.stations.back().translation, shift(tool));
  const double angle = norm(rotation_vector(tool.pose()));
  return body.kinetic + body.elastic +
         0.5 * (c.mass * dot(tool.velocity(), tool.velocity()) +
                c.inertia * dot(tool.spin(), tool.spin()) + c.stiffness * dot(stretch, stretch) +
                c.turning_stiffness * angle * angle);
}

// The nodes weigh up to 37 kg: much more than the light tools, which a scheme that exchanges forces
// once per step would throw back faster than they came.
// With a blade, a tool is not lighter than a quarter of a node.
void expect_passive(bool has_blade) {
  for (const double mass : has_blade ? std::array{10., 100., 1e3} : std::array{0.1, 1., 1e3})
    for (const double stiffness : {1e1, 1e5, 1e9}) {
      Obstacle obstacle = presser();
      obstacle.motion.stations = {{0, {0, 0, 0.02}, 0}, {0.01, {0.01, 0, -0.05}, 0}};
      obstacle.coupling = Coupling{mass, stiffness, 0, 0.03 * mass, 0.1 * stiffness, 0};
      obstacle.pushes = !has_blade;
      Pressed pressed(obstacle);
      if (has_blade) pressed.contact.add_edge(edge_in_the_block());
      const double dt = 0.3 * pressed.stable_step();
      pressed.run(dt, static_cast<int>(0.01 / dt) + 2);  // the hand has stopped
      const double start = energy(pressed, *obstacle.coupling, obstacle);
      double before = start;
      for (int i = 0; i < 300; ++i) {
        pressed.run(dt, 1);
        const double now = energy(pressed, *obstacle.coupling, obstacle);
        // The steps of the body exchange kinetic and elastic energy to within their order.
        ASSERT_LT(now, before * 1.03 + 1e-9) << mass << " kg, " << stiffness << " N/m, step " << i;
        before = std::min(before, now);
      }
    }
}
TEST(Tool, IsPassiveForAnyMassAndStiffness) { expect_passive(false); }
TEST(Tool, IsPassiveWithABladeThatIsResisted) { expect_passive(true); }

TEST(Tool, IsThrownBackByABodyThatComesFaster) {
  Obstacle tool = ball({{0, {}, 0}});
  tool.coupling = Coupling{50, 1e-3, 0, 1, 1e-3, 0};  // free, in effect
  Pressed thrown(tool, rig::euler, false);
  Attributes& a = thrown.body.attributes();
  for (Index v = 0; v < a.vertex_count(); ++v) a.velocity().set(v, 2, 1);
  const double momentum = thrown.mass(), dt = 0.3 * thrown.stable_step();
  thrown.run(dt, static_cast<int>(0.1 / dt));
  double after = 50 * thrown.tool().velocity()[2];
  for (Index v = 0; v < a.vertex_count(); ++v) after += a.mass().get(v, 0) * a.velocity().get(v, 2);
  EXPECT_NEAR(after, momentum, 1e-6 * momentum) << "but for the spring";
  EXPECT_GT(thrown.tool().velocity()[2], 0.9);
}

TEST(Tool, ASheetBetweenTwoToolsStaysOutOfBoth) {
  Obstacle above = presser(0), below = above;
  below.name = "below";
  below.shape = Sphere{{0.5, 0.5, -1}, 1};
  below.motion.centre = {0.5, 0.5, -1};
  for (auto* tool : {&above, &below}) tool->motion.stations = {{0, {}, 0}, {0.05, {}, 0}};
  above.motion.stations[1].translation = {0, 0, -0.1};
  below.motion.stations[1].translation = {0, 0, 0.1};
  rig::Block sheet("tm-faure", {{"E", 4e5}, {"nu", 0.3}, {"rho", 1000}}, {3, 3, 3}, 1. / 3,
                   {rig::euler, 0, {}, {}});
  Contact& contact = sheet.body.add_contact({above, below}, 0);
  sheet.start();
  const double dt = 0.4 * sheet.stable_step();
  for (int i = 0; i < 300; ++i) {
    sheet.run(dt, 1);
    for (const double gap : contact.gaps(sheet.dynamics.time()))
      if (!std::isnan(gap)) {
        ASSERT_GT(gap, -1e-7);
      }
  }
  EXPECT_NEAR(contact.loads()[0].force[2], -contact.loads()[1].force[2],
              0.2 * contact.loads()[0].force[2]);
  EXPECT_GT(contact.loads()[0].force[2], 300);
}

TEST_P(ToolSchemes, ARollbackRepeatsTheSameBitsOfTheTool) {
  Pressed pressed(presser(), GetParam());
  const double dt = 0.5 * pressed.stable_step();
  pressed.run(dt, 100);
  StateBuffer kept;
  kept.save(pressed.dynamics);
  const double time = pressed.dynamics.time();
  const auto finish = [&] {
    for (int i = 1; i <= 100; ++i) pressed.dynamics.step(dt, time + i * dt);
    std::vector<double> all = pressed.Rig::state();
    for (const Vec3& a : {shift(pressed.tool()), pressed.tool().velocity(), pressed.tool().spin(),
                          pressed.tool().hand_force(), rotation_vector(pressed.tool().pose())})
      all.insert(all.end(), a.begin(), a.end());
    return all;
  };
  const std::vector<double> first = finish();
  kept.load(pressed.dynamics);
  EXPECT_EQ(finish(), first);
}

}  // namespace
}  // namespace suture::tool_test
