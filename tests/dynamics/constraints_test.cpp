// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/constraints.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tests/dynamics/rig.hpp"
#include "tests/forces/load_sums.hpp"

namespace {

using namespace suture;
using namespace rig;
using namespace spring_model;

PrescribedMotion along(const Vec3& translation, const TimeRamp& ramp = {0, 1, false}) {
  PrescribedMotion motion;
  motion.translation = translation;
  motion.ramp = ramp;
  return motion;
}

/// Where and how fast a vertex is held at a time, m and m/s.
struct Held {
  Held(Rig& rig, Index v, double time) {
    rig.body.constraints().apply(rig.body.attributes(), time);
    for (int c = 0; c < 3; ++c) {
      shift[c] = rig.shift(v, c);
      x[c] = rig.x(v, c);
      velocity[c] = rig.body.attributes().velocity().get(v, c);
    }
  }
  Eigen::Vector3d shift, x, velocity;
};

TEST(Constraints, TurnAsRodriguesSaysAndVelocityIsTheDerivative) {
  for (const bool smooth : {false, true}) {
    Moving m(box(2, 2, 2));
    PrescribedMotion turn = along({0.3, -0.2, 0.1}, {0.5, 2.5, smooth});
    turn.axis = {1, 2, -2};
    turn.centre = {0.1, -0.3, 0.2};
    turn.angle = 2.1;
    const auto all = all_vertices(m.body);
    m.hold(all, 7, turn);
    EXPECT_EQ(m.body.constraints().last_change(), 2.5);
    const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, -2).normalized(), centre(0.1, -0.3, 0.2);
    for (const double time : {0.2, 0.9, 1.7, 3.0})
      for (const Index v : all) {
        const Held now(m, v, time), later(m, v, time + 1e-6), sooner(m, v, time - 1e-6);
        const double s = turn.ramp.value(time);
        const Eigen::Vector3d rest = now.x - now.shift;
        const Eigen::Vector3d x = centre + Eigen::AngleAxisd(s * 2.1, axis) * (rest - centre) +
                                  s * Eigen::Vector3d(0.3, -0.2, 0.1);
        ASSERT_LT((now.x - x).norm(), 1e-15);
        ASSERT_LT((now.velocity - (later.x - sooner.x) / 2e-6).norm(), 1e-8);
      }
  }
}

TEST(Constraints, WhereGroupsOverlapTheLastWinsInItsComponents) {
  Moving m(box(2, 2, 1));
  const auto side = m.at(0, 0), bottom = m.at(1, 0);
  m.hold(side, 7);
  m.hold(bottom, 5, along({0.1, 0.2, 0.3}));
  const Column& fixed = m.body.attributes().fixed();
  const auto always_fixed = m.body.constraints().always_fixed(m.body.attributes().vertex_count());
  EXPECT_EQ(m.body.constraints().vertex_count(), side.size() + bottom.size());
  for (const Index v : all_vertices(m.body)) {
    const bool in_side = std::ranges::count(side, v) != 0;
    const bool in_bottom = std::ranges::count(bottom, v) != 0;
    EXPECT_EQ(fixed.get(v, 0), in_side ? 7 : in_bottom ? 5 : 0);
    EXPECT_EQ(always_fixed[v], in_side && !in_bottom);
    const Eigen::Vector3d expected =
        in_bottom ? Eigen::Vector3d(0.05, 0, 0.15) : Eigen::Vector3d(0, 0, 0);
    EXPECT_LT((Held(m, v, 0.5).shift - expected).norm(), 1e-15) << v;
  }
}

TEST(Constraints, StepsMoveNoVertexFartherThanItsReach) {
  Moving m(box(1, 1, 1));
  EXPECT_TRUE(std::isinf(m.body.constraints().longest_step(0)));
  PrescribedMotion turn = along({0, 0, 0.2}, {1, 3, false});
  turn.axis = {0, 0, 5};
  turn.angle = -3;
  turn.reach = 1e-3;
  m.hold(m.at(0, 0.1), 7, turn);
  const double way = 0.2 + 3 * std::hypot(0.1, 0.1);  // of the vertex farthest from the axis
  EXPECT_NEAR(m.body.constraints().longest_step(2), 1e-3 / (way / 2), 1e-15);
  EXPECT_TRUE(std::isinf(m.body.constraints().longest_step(0.5)));
  EXPECT_TRUE(std::isinf(m.body.constraints().longest_step(3)));
  turn.ramp.smooth = true;
  m.hold(m.at(0, 0.1), 7, turn);
  EXPECT_NEAR(m.body.constraints().longest_step(2), 1e-3 / (1.5 * way / 2), 1e-15);
}

// A plate of mass M at constant speed v against four springs, K u: work K u^2/2 + M v^2/2. The
// trapezoid is exact there.
TEST(Constraints, DrivenWorkIsThatOfTheSpringsAndTheSpeed) {
  for (const char* scheme : schemes) {
    Moving m(box(1, 1, 1), {scheme, 0, {}, {}});
    m.hold(m.at(0, 0), 7);
    const auto plate = m.at(0, 0.1);
    m.hold(plate, 7, along({0.02, 0, 0}, {0, 2, false}));
    m.dynamics.start();
    for (const Index v : plate) m.body.attributes().velocity().set(v, 0, 0);
    m.dynamics.balance();
    for (int i = 1; i <= 50; ++i) {
      m.step(0.01);
      const double u = 0.01 * m.dynamics.time();
      const EnergyBalance b = m.dynamics.balance();
      ASSERT_NEAR(b.prescribed, Oscillator::k * u * u / 2 + Oscillator::m * 1e-4 / 2, 1e-15) << i;
    }
  }
}

TEST(Constraints, PartsOfASplitVertexMoveTogetherAndTheirWorkContinues) {
  for (const char* scheme : schemes) {
    Moving m(box(4, 2, 2), {scheme, 0, {}, {}});
    const TimeRamp ramp{0, 0.4, true};  // mean velocities are not those at the end of a step
    m.hold(m.at(1, 0), 7, along({0.01, 0, 0.02}, ramp));
    m.start();
    m.run(1e-3, 100);
    const EnergyBalance before = m.dynamics.balance();
    const Index held = m.body.constraints().vertex_count();
    const TopologyChange change = m.body.cut(left_sides(section(m.body, 0.2)));
    std::vector<Index> fresh;
    for (const Split& s : change.splits[0])
      if (m.body.attributes().rest().get(s.new_cell, 1) < 1e-9) fresh.push_back(s.new_cell);
    ASSERT_EQ(fresh.size(), 3u);
    EXPECT_EQ(m.body.constraints().vertex_count(), held + 3);
    EXPECT_NEAR(m.dynamics.balance().prescribed, before.prescribed, 1e-13 * before.exchanged);
    m.run(1e-3, 100);
    for (const Index v : fresh) {
      EXPECT_EQ(m.body.attributes().fixed().get(v, 0), 7);
      EXPECT_NEAR(m.shift(v, 2), 0.02 * ramp.value(0.2), 1e-15);
    }
    const EnergyBalance after = m.dynamics.balance();
    EXPECT_LT(std::abs(after.balance), 1e-3 * after.exchanged) << "no work is lost at the cut";
  }
}

/// A block cut at x = 0.2 m: vertices that will stay and that will go when it is sewn.
struct Wound : Moving {
  Wound() : Moving(box(4, 2, 2)), seams(section(body, 0.2)) {
    Moving twin(box(4, 2, 2));
    twin.body.cut(left_sides(seams));
    const TopologyChange sewn = twin.body.sew(seams);
    for (const Merge& merge : sewn.merges[0]) {
      kept.push_back(merge.kept);
      gone.push_back(merge.gone);
    }
    body.cut(left_sides(seams));
  }
  std::vector<Seam> seams;
  std::vector<Index> kept, gone;
};

TEST(Constraints, WhatHeldAVertexThatGoesHoldsTheOneThatStays) {
  Wound m;
  ASSERT_EQ(m.gone.size(), 9u);
  m.hold(m.gone, 3, along({0.1, 0.2, 0}));
  m.body.sew(m.seams);
  EXPECT_EQ(m.body.constraints().vertex_count(), 9u);
  for (const Index v : m.kept) {
    EXPECT_EQ(m.body.attributes().fixed().get(v, 0), 3);
    EXPECT_LT((Held(m, v, 0.5).shift - Eigen::Vector3d(0.05, 0.1, 0)).norm(), 1e-15);
  }
}

// Whichever group was added first.
TEST(Constraints, ComponentsThatAreHeldKeepTheMotionOfTheVertexThatStays) {
  for (const bool first : {false, true}) {
    Wound m;
    if (first) m.hold(m.kept, 1, along({0.4, 0, 0}));
    m.hold(m.gone, 7, along({0.1, 0.2, 0.3}));
    if (!first) m.hold(m.kept, 1, along({0.4, 0, 0}));
    m.body.sew(m.seams);
    for (const Index v : m.kept) {
      EXPECT_EQ(m.body.attributes().fixed().get(v, 0), 7);
      EXPECT_LT((Held(m, v, 0.5).shift - Eigen::Vector3d(0.2, 0.1, 0.15)).norm(), 1e-15) << first;
    }
    m.body.cut(left_sides(m.seams));  // and both parts later
    Index parts = 0;
    for (const Index v : m.at(0, 0.2)) {
      if (!m.body.complex().exists(0, v)) continue;
      ++parts;
      EXPECT_LT((Held(m, v, 0.5).shift - Eigen::Vector3d(0.2, 0.1, 0.15)).norm(), 1e-15) << first;
    }
    EXPECT_EQ(parts, 18u);
  }
}

TEST(Constraints, ForgetWhatIsRemoved) {
  Moving m(box(4, 2, 2));
  m.hold(m.at(0, 0), 7);
  m.hold(m.at(1, 0), 7, along({0, 0, 0.1}));
  const Index before = m.body.constraints().vertex_count();
  ASSERT_EQ(before, 9u + 15u);
  std::vector<Index> column;
  for (Index e = 0; e < m.body.complex().element_count(); ++e) {
    double x = 0;
    for (const Index v : m.body.complex().vertices_of(e))
      x += m.body.attributes().rest().get(v, 0) / 8;
    if (x < 0.1) column.push_back(e);
  }
  ASSERT_EQ(column.size(), 4u);
  m.dynamics.start();
  m.body.pierce(column);
  EXPECT_EQ(m.body.constraints().vertex_count(), 12u) << "3 of 15 and all 9 are gone";
  m.run(1e-3, 10);
  EXPECT_NEAR(m.shift(m.at(0, 0.4)[0], 2),
              m.body.attributes().rest().get(m.at(0, 0.4)[0], 1) < 1e-9 ? 1e-3 : 0, 1e-12);
}

}  // namespace
