// SPDX-License-Identifier: GPL-3.0-or-later
//
// An elastic block that meets obstacles: impulses, friction, the ledger, and states.
#include <gtest/gtest.h>

#include <numbers>

#include "kernel/contact/overlap.hpp"
#include "tests/dynamics/model_block.hpp"

namespace suture {
namespace {

Obstacle half_space(const Vec3& point, const Vec3& normal, double friction = 0) {
  return {"floor", "/contact/obstacles/0", HalfSpace{point, normal}, {}, friction};
}

/// A block of 1 m above a floor.
struct Falling : rig::Block {
  explicit Falling(const std::string& scheme, std::vector<Obstacle> obstacles, double thickness = 0,
                   const Vec3& weight = {0, 0, -10})
      : Block("tm-faure", {{"E", 4e5}, {"nu", 0.3}, {"rho", 1000}}, {3, 3, 3}, 1. / 3,
              {scheme, 0, weight, {}}),
        contact(body.add_contact(std::move(obstacles), thickness)) {}
  std::vector<Index> at(int axis, double where) {
    return vertices(
        [&](const Vec3& x) { return std::abs(x[static_cast<std::size_t>(axis)] - where) < 1e-9; });
  }
  double lowest(int axis = 2) const {
    double low = 1e9;
    for (Index v = 0; v < body.attributes().vertex_count(); ++v) low = std::min(low, x(v, axis));
    return low;
  }
  double fastest() {
    double speed = 0;
    for (Index v = 0; v < body.attributes().vertex_count(); ++v)
      speed = std::max(speed, norm(row(body.attributes().velocity().rows(), v)));
    return speed;
  }
  Vec3 momentum() {
    Vec3 sum{};
    Attributes& a = body.attributes();
    for (Index v = 0; v < a.vertex_count(); ++v)
      for (int c = 0; c < 3; ++c)
        sum[static_cast<std::size_t>(c)] += a.mass().get(v, 0) * a.velocity().get(v, c);
    return sum;
  }
  Contact& contact;
};

class Schemes : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Contact, Schemes, testing::ValuesIn(rig::schemes), [](const auto& test) {
  return std::string(test.param, 6) == "veloci" ? "verlet" : "euler";
});

TEST_P(Schemes, NothingEntersTheFloor) {
  Falling falling(GetParam(), {half_space({0, 0, -0.05}, {0, 0, 1}, 0.5)});
  falling.start();
  const double dt = 0.5 * falling.stable_step();
  int touching = 0;
  for (int i = 0; i < 400; ++i) {
    falling.run(dt, 1);
    EXPECT_GE(falling.lowest(), -0.05 - 1e-15);
    touching += !falling.contact.touches().empty();
  }
  EXPECT_GT(touching, 20);
}

TEST_P(Schemes, KeepTheThickness) {
  Falling falling(GetParam(), {half_space({0, 0, -0.05}, {0, 0, 1})}, 0.02);
  falling.start();
  falling.run(0.5 * falling.stable_step(), 400);
  EXPECT_NEAR(falling.lowest(), -0.03, 0.01);
  EXPECT_GE(falling.lowest(), -0.03 - 1e-15);
}

// Short steps follow small pieces that are squeezed, and fast approach: with a fixed way in each,
// depths would come back ever faster.
TEST_P(Schemes, ADepthComesBackNoFasterInShortSteps) {
  const Obstacle ball{"ball", "/contact/obstacles/0", Sphere{{0.5, 0.5, -2}, 2.05}, {}, 0};
  for (const Obstacle& obstacle : {half_space({0, 0, 0.05}, {0, 0, 1}), ball}) {
    Falling deep(GetParam(), {obstacle}, 0, {0, 0, 0});
    deep.start();
    const double dt = 0.5 * deep.stable_step();
    deep.run(dt, 1);
    const double fastest = deep.fastest();
    deep.run(1e-4 * dt, 1);
    EXPECT_GT(fastest, 0);
    EXPECT_LT(deep.fastest(), 2 * fastest);
  }
}

// The change of momentum is weight plus contact, and what the floor receives is the opposite.
TEST_P(Schemes, ImpulsesEqualTheChangeOfMomentum) {
  Falling falling(
      GetParam(),
      {half_space({0, 0, -0.01}, {0, 0, 1}, 0.4), half_space({-0.01, 0, 0}, {1, 0, 0}, 0.1)}, 0,
      {-3, 1, -10});
  falling.start();
  const double dt = 0.5 * falling.stable_step(), mass = falling.mass();
  falling.run(dt, 1);
  double largest = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 before = falling.momentum();
    falling.run(dt, 1);
    const Vec3 after = falling.momentum();
    Vec3 floors{}, vertices{};
    for (const Contact::Load& load : falling.contact.loads()) floors = plus(floors, load.force);
    for (const Contact::Touch& touch : falling.contact.touches())
      vertices = plus(vertices, touch.force);
    const Vec3 weight = scaled(mass * dt, {-3, 1, -10});
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(vertices[c], -floors[c], 1e-12 * (1 + std::abs(floors[c])));
      EXPECT_NEAR(after[c] - before[c], weight[c] + dt * vertices[c], 1e-12 * mass);
    }
    largest = std::max(largest, norm(vertices));
  }
  EXPECT_GT(largest, mass);
}

TEST_P(Schemes, FrictionObeysCoulomb) {
  const double friction = 0.25;
  Falling falling(GetParam(), {half_space({0, 0, 0}, {0, 0, 1}, friction)}, 0, {5, 0, -10});
  falling.start();
  const double dt = 0.5 * falling.stable_step();
  int sliding = 0;
  for (int i = 0; i < 300; ++i) {
    falling.run(dt, 1);
    for (const Contact::Touch& touch : falling.contact.touches()) {
      const double tangential = std::hypot(touch.force[0], touch.force[1]);
      EXPECT_LE(tangential, friction * touch.force[2] * (1 + 1e-9));
      const bool slides =
          std::abs(falling.body.attributes().velocity().get(touch.vertex, 0)) > 1e-9;
      if (slides && touch.force[2] > 1e-3) {
        EXPECT_NEAR(tangential, friction * touch.force[2], 1e-6 * touch.force[2]);
        ++sliding;
      }
    }
  }
  EXPECT_GT(sliding, 50) << "tan of the slope is 0.5";
}

TEST_P(Schemes, TheLedgerClosesWithImpactsAndFriction) {
  double balance[2];
  for (const int refinement : {0, 1}) {
    Falling falling(GetParam(), {half_space({0, 0, -0.02}, {0, 0, 1}, 0.3)}, 0, {4, 0, -10});
    falling.start();
    const double dt = 0.4 * falling.stable_step() / (1 + refinement);
    falling.run(dt, 500 * (1 + refinement));
    const EnergyBalance books = falling.dynamics.balance();
    EXPECT_LT(books.work("friction"), -0.01 * books.exchanged);
    EXPECT_LT(books.work("contact"), 0) << "impacts are inelastic";
    EXPECT_GT(books.work("contact"), -0.5 * books.exchanged);
    balance[refinement] = std::abs(books.balance - books.recoverable) / books.exchanged;
  }
  EXPECT_LT(balance[0], 0.01);
  EXPECT_LT(balance[1], 0.005);
}

TEST(Contact, AMovingObstacleDoesTheWorkThatTheBodyGains) {
  Obstacle piston = half_space({-0.01, 0, 0}, {1, 0, 0});
  piston.motion.stations = {{0, {}, 0}, {10, {10, 0, 0}, 0}};
  Falling pushed(rig::euler, {piston}, 0, {});
  pushed.start();
  const double dt = 0.2 * pushed.stable_step();
  const int steps = 4000;
  double work = 0;
  for (int i = 0; i < steps; ++i) {
    pushed.run(dt, 1);
    work += dt * -pushed.contact.loads()[0].force[0];  // its speed is 1 m/s
  }
  const EnergyBalance books = pushed.dynamics.balance();
  EXPECT_NEAR(pushed.momentum()[0], work, 1e-9 * work) << "at 1 m/s, impulse and work are equal";
  EXPECT_GT(books.kinetic, 0.5 * pushed.mass() * 0.9);
  EXPECT_NEAR(books.balance, 0, 0.01 * books.exchanged);
}

TEST(Contact, FrictionDragsTheBodyAlong) {
  Obstacle belt{"belt", "/contact/obstacles/0", Box{{-5, -5, -1}, {5, 5, 0}}, {}, 0.5};
  belt.motion.stations = {{0, {}, 0}, {10, {10, 0, 0}, 0}};
  Falling dragged(rig::euler, {belt});
  dragged.start();
  const double dt = 0.5 * dragged.stable_step();
  const int steps = static_cast<int>(2 / dt);
  double mean = 0;  // it starts suddenly, and sways
  for (int i = 0; i < 2 * steps; ++i) {
    dragged.run(dt, 1);
    if (i >= steps) mean += dragged.momentum()[0] / dragged.mass() / steps;
  }
  EXPECT_NEAR(mean, 1, 0.02) << "the speed of the belt";
  EXPECT_GE(dragged.lowest(), -1e-14);
}

// A wedge of two planes: each alone would push into the other.
TEST(Contact, AVertexBetweenTwoObstaclesIsInNeither) {
  const double s = std::sqrt(0.5);
  Falling falling(rig::euler, {half_space({0.5, 0, -0.55}, {s, 0, s}, 0.2),
                               half_space({0.5, 0, -0.55}, {-s, 0, s}, 0.2)});
  falling.start();
  const double dt = 0.3 * falling.stable_step();
  int both = 0;
  for (int i = 0; i < 1500; ++i) {
    falling.run(dt, 1);
    const auto& loads = falling.contact.loads();
    both += norm(loads[0].force) > 0 && norm(loads[1].force) > 0;
    for (const double gap : falling.contact.gaps(falling.dynamics.time()))
      if (!std::isnan(gap)) {
        EXPECT_GT(gap, -1e-6);
      }
  }
  EXPECT_GT(both, 20);
}

TEST(Contact, PrescribedComponentsStay) {
  Falling falling(rig::euler, {half_space({0, 0, -0.005}, {0.6, 0, 0.8}, 0.3)});
  const std::vector<Index> left = falling.at(0, 0), top = falling.at(2, 1);
  falling.hold(left, 1);  // x only
  falling.hold(top, 7);
  falling.start();
  falling.run(0.5 * falling.stable_step(), 300);
  for (const Index v : left) EXPECT_EQ(falling.shift(v, 0), 0);
  for (const Index v : top) EXPECT_EQ(falling.shift(v, 2), 0);
  EXPECT_FALSE(falling.contact.touches().empty());
}

TEST(Contact, WhatStartsInsideIsPushedOutSlowly) {
  Obstacle floor = half_space({0, 0, 0.1}, {0, 0, 1});
  floor.push_out = true;
  Falling falling(rig::euler, {floor}, 0, {});
  falling.start();
  const double dt = 0.5 * falling.stable_step();
  double speed = 0;
  for (int i = 0; i < 2000; ++i) {
    falling.run(dt, 1);
    speed = std::max(speed, std::abs(falling.momentum()[2]) / falling.mass());
  }
  EXPECT_GT(falling.lowest(), 0.1 - 1e-3);
  EXPECT_LT(speed * dt, 0.01 / 3) << "a hundredth of an element per step";
}

// ------------------------------------------------------------------- overlaps --

std::vector<Overlap> overlaps_of(Falling& falling) {
  return find_overlaps(falling.contact, falling.body.complex(), falling.body.attributes(), 0);
}

TEST(Overlaps, AreFoundWithTheirDepth) {
  Falling falling(rig::euler, {half_space({0, 0, 0.1}, {0, 0, 1}),
                               half_space({0, 0, 0}, {0, 0, 1}),
                               {"ball", "", Sphere{{0.5, 0.5, 1.2}, 0.25}}});
  falling.start();
  const std::vector<Overlap> found = overlaps_of(falling);
  ASSERT_EQ(found.size(), 1u) << "a floor that touches is none";
  EXPECT_EQ(found[0].obstacle, 0u);
  EXPECT_EQ(found[0].vertices, 16u);
  EXPECT_NEAR(found[0].depth, 0.1, 1e-15);
}

TEST(Overlaps, AnObstacleInsideAnElementIsFound) {
  Falling falling(rig::euler, {{"ball", "", Sphere{{0.5, 0.5, 0.5}, 0.1}},
                               {"needle", "", Capsule{{0.5, 0.5, 1.5}, {0.5, 0.5, 0.5}, 0.01}},
                               {"away", "", Sphere{{0.5, 0.5, 1.2}, 0.1}}});
  falling.start();
  const std::vector<Overlap> found = overlaps_of(falling);
  ASSERT_EQ(found.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(found[i].obstacle, i);
    EXPECT_EQ(found[i].vertices, 0u);
  }
}

// --------------------------------------------------------- operations and states --

TEST(Contact, SeesTheVerticesThatACutMakes) {
  Falling falling(rig::euler, {half_space({0, 0, -0.01}, {0, 0, 1}, 0.2)});
  falling.start();
  const double dt = 0.5 * falling.stable_step();
  falling.run(dt, 50);
  std::vector<Dart> faces;
  const CellComplex& complex = falling.body.complex();
  for (Dart d = 0; d < 24 * complex.element_count(); d += 4)
    if (complex.can_cut(d) && d / 24 / 9 != complex.beta3(d) / 24 / 9) faces.push_back(d);
  falling.body.cut(faces);  // into three layers
  EXPECT_EQ(falling.contact.surface().vertices().size(), 3u * 32);
  for (int i = 0; i < 100; ++i) {
    falling.run(dt, 1);
    EXPECT_GE(falling.lowest(), -0.01 - 1e-15);
  }
  const std::vector<double> gaps = falling.contact.gaps(falling.dynamics.time());
  EXPECT_EQ(std::ranges::count_if(gaps, [](double g) { return std::isnan(g); }), 0);
}

TEST_P(Schemes, ARollbackRepeatsTheSameBits) {
  Falling falling(GetParam(), {half_space({0, 0, -0.01}, {0, 0, 1}, 0.3)}, 0, {2, 0, -10});
  falling.start();
  const double dt = 0.5 * falling.stable_step();
  falling.run(dt, 120);
  StateBuffer kept;
  kept.save(falling.dynamics);
  const double time = falling.dynamics.time();
  const auto finish = [&] {
    for (int i = 1; i <= 80; ++i) falling.dynamics.step(dt, time + i * dt);
    std::vector<double> all = falling.Rig::state();
    const EnergyBalance books = falling.dynamics.balance();
    all.insert(all.end(), {books.work("contact"), books.work("friction"), books.balance});
    return all;
  };
  const std::vector<double> first = finish();
  kept.load(falling.dynamics);
  EXPECT_EQ(finish(), first);
}

TEST_P(Schemes, LookingAtTheStateChangesNoBit) {
  const auto run = [&](bool looks) {
    Falling falling(GetParam(), {half_space({0, 0, -0.01}, {0, 0, 1}, 0.3)}, 0, {2, 0, -10});
    falling.start();
    const double dt = 0.5 * falling.stable_step();
    for (int i = 0; i < 200; ++i) {
      falling.run(dt, 1);
      if (looks && i % 7 == 0) falling.dynamics.synchronise();
    }
    falling.dynamics.synchronise();
    return falling.Rig::state();
  };
  EXPECT_EQ(run(true), run(false));
}

}  // namespace
}  // namespace suture
