// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sleeping islands: they cost nothing, do not affect others, and the error stays below the bound
// given in the header.
#include "kernel/dynamics/sleep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "kernel/base/error.hpp"
#include "tests/dynamics/rig.hpp"

namespace {

using namespace suture;
using namespace rig;
using spring_model::defaults;

/// A block cut into a left and a right island.
struct TwoIslandsBody : spring_model::Body {
  explicit TwoIslandsBody(std::vector<double> parameters) : Body(spring_model::box(6, 3, 3), true) {
    add(std::move(parameters));
    compile();
    std::vector<Dart> faces;
    for (Index e = 0; e < complex().element_count(); ++e)
      (imported().user_element[e] % 6 < 3 ? left : right).push_back(e);
    for (const Index e : left)
      for (Dart f = 0; f < 6; ++f) {
        const Index n = complex().neighbour(e, static_cast<int>(f));
        if (n != none && imported().user_element[n] % 6 >= 3) faces.push_back(24 * e + 4 * f);
      }
    cut(faces);
  }
  std::vector<Index> left, right;
};

struct TwoIslands : TwoIslandsBody, Rig {
  TwoIslands(std::vector<double> parameters, const Options& options)
      : TwoIslandsBody(std::move(parameters)), Rig(*this, options) {}
  void go(int steps, double dt) {
    for (int i = 0; i < steps; ++i, time += dt) dynamics.step(dt, time + dt);
  }
  std::vector<double> rows(const Column& column, const std::vector<Index>& elements) const {
    std::vector<double> values;
    for (const Index e : elements)
      for (const Index v : complex().vertices_of(e))
        for (int c = 0; c < 3; ++c) values.push_back(column.get(v, c));
    return values;
  }
  double time = 0;
};

Options falling(const char* scheme) { return {scheme, 0, {0, -10, 0}, {}}; }

TEST(Sleep, OthersMoveTheSameBitsAndSleepersStay) {
  for (const char* scheme : {euler, verlet, "xpbd"}) {
    auto parameters = defaults();
    if (scheme == std::string("xpbd")) parameters[spring_model::diagonal_stiffness] = 0;
    TwoIslands awake(parameters, falling(scheme)), half(parameters, falling(scheme));
    for (TwoIslands* body : {&awake, &half}) {
      body->shake(0.01, 3);
      body->dynamics.start();
      body->go(10, 1e-4);
    }
    put_to_sleep(half.dynamics, half.left);
    EXPECT_TRUE(sleeps(half.dynamics));
    const auto place = half.rows(half.attributes().position(), half.left);
    const auto force = half.rows(half.attributes().force(), half.left);
    for (TwoIslands* body : {&awake, &half}) body->go(50, 1e-4);
    for (TwoIslands* body : {&awake, &half}) body->dynamics.synchronise();
    using Get = Column& (Attributes::*)();
    for (const Get column :
         {Get{&Attributes::position}, Get{&Attributes::velocity}, Get{&Attributes::force}})
      EXPECT_EQ(half.rows((half.attributes().*column)(), half.right),
                awake.rows((awake.attributes().*column)(), awake.right));
    EXPECT_EQ(half.rows(half.attributes().position(), half.left), place);
    EXPECT_EQ(half.rows(half.attributes().force(), half.left), force) << "those of before";
    for (const double v : half.rows(half.attributes().velocity(), half.left)) EXPECT_EQ(v, 0);
    EXPECT_NE(awake.rows(awake.attributes().position(), awake.left), place);
    wake_all(half.dynamics);
    half.dynamics.synchronise();
    EXPECT_NE(half.rows(half.attributes().force(), half.left), std::vector<double>(force.size()));
    half.go(20, 1e-4);
    EXPECT_NE(half.rows(half.attributes().position(), half.left), place);
  }
}

TEST(Sleep, SleepersAreNotComputed) {
  auto parameters = defaults();
  const TwoIslands body(parameters, {});
  const auto highest = [&](const std::vector<Index>& elements) {
    Index edge = 0;
    for (const Index e : elements)
      for (const Index i : body.complex().edges_of(e)) edge = std::max(edge, i);
    return edge;
  };
  // Edges that only one island has fail when they are computed.
  const bool right = highest(body.right) > highest(body.left);
  parameters[spring_model::fail_from] = highest(right ? body.left : body.right) + 1;
  TwoIslands failing(parameters, {});
  failing.dynamics.start();
  EXPECT_THROW(failing.dynamics.step(1e-4, 1e-4), NumericalError);
  failing.models().sleep(right ? failing.right : failing.left);
  EXPECT_NO_THROW(failing.dynamics.step(1e-4, 1e-4));
  failing.models().wake_all();
  EXPECT_THROW(failing.dynamics.step(1e-4, 2e-4), NumericalError);
}

TEST(Sleep, AnyOperationWakes) {
  TwoIslands body(defaults(), falling(euler));
  body.dynamics.start();
  put_to_sleep(body.dynamics, body.left);
  put_to_sleep(body.dynamics, body.right);  // one after the other
  const auto place = body.rows(body.attributes().position(), body.left);
  body.go(5, 1e-4);
  EXPECT_EQ(body.rows(body.attributes().position(), body.left), place);
  body.pierce({body.right[0]});
  EXPECT_FALSE(sleeps(body.dynamics));
  body.go(5, 1e-4);
  // It has fallen for five steps: v = 5 g dt.
  for (const Index v : body.complex().vertices_of(body.left[0]))
    EXPECT_NEAR(body.attributes().velocity().get(v, 1), -10 * 5e-4, 1e-12);
}

TEST(Sleep, OnlyWholeIslandsSleep) {
  TwoIslands body(defaults(), {});
  body.dynamics.start();
  EXPECT_THROW(put_to_sleep(body.dynamics, std::span(body.left).first(3)), InputError);
  EXPECT_THROW(put_to_sleep(body.dynamics, std::vector<Index>{9999}), InputError);
  EXPECT_FALSE(sleeps(body.dynamics));
}

/// The motion that a sleep omits, against the header's bound v T + a T^2 / 2.
TEST(Sleep, WhatIsLostStaysBelowTheBound) {
  const Options options = falling(verlet);
  TwoIslands body(defaults(), options);
  std::vector<Index> held;
  for (const Index e : body.left)
    for (const Index v : body.complex().vertices_of(e))
      if (body.attributes().rest().get(v, 0) < 1e-9) held.push_back(v);
  body.hold(held, 7);
  body.dynamics.start();
  body.dynamics.motion().set_damping(3);
  body.go(20000, 1e-3);  // hangs nearly still
  body.dynamics.motion().set_damping(0);
  const auto still = stillness(body.dynamics, body.left);
  EXPECT_GT(still.velocity + still.acceleration, 0);
  EXPECT_LT(still.acceleration, 0.1) << "against 10 of gravity";
  EXPECT_NEAR(stillness(body.dynamics, body.right).acceleration, 10, 1e-6) << "it falls";
  const auto before = body.rows(body.attributes().position(), body.left);
  const int steps = 200;
  body.go(steps, 1e-3);
  const double T = steps * 1e-3;
  double squares = 0, mass = 0;
  std::size_t i = 0;
  for (const Index e : body.left)
    for (const Index v : body.complex().vertices_of(e)) {
      const double m = body.attributes().mass().get(v, 0);
      mass += m;
      for (int c = 0; c < 3; ++c, ++i)
        squares += m * std::pow(body.attributes().position().get(v, c) - before[i], 2);
    }
  const double lost = std::sqrt(squares / mass);
  EXPECT_GT(lost, 0);
  EXPECT_LT(lost, still.velocity * T + still.acceleration * T * T / 2);
}

}  // namespace
