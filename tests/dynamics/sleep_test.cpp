// SPDX-License-Identifier: GPL-3.0-or-later
//
// Islands that sleep: they cost nothing, change nothing for others, and what is lost stays
// below the bound of the header.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "kernel/base/error.hpp"
#include "kernel/dynamics/dynamics.hpp"
#include "tests/forces/spring_model.hpp"

namespace {

using namespace suture;
using spring_model::Body;

/// A block cut into a left and a right island.
struct TwoIslands : Body {
  TwoIslands(std::vector<double> parameters, const DynamicsOptions& options)
      : Body({.size = {0.6, 0.3, 0.3}, .cells = {6, 3, 3}}, true) {
    add(std::move(parameters));
    initialise();
    std::vector<Dart> faces;
    for (Index e = 0; e < mesh.complex.element_count(); ++e)
      (mesh.user_element[e] % 6 < 3 ? left : right).push_back(e);
    for (const Index e : left)
      for (Dart f = 0; f < 6; ++f) {
        const Index n = mesh.complex.neighbour(e, static_cast<int>(f));
        if (n != none && mesh.user_element[n] % 6 >= 3) faces.push_back(24 * e + 4 * f);
      }
    attributes->apply(mesh.complex, mesh.complex.cut(faces));
    dynamics = std::make_unique<Dynamics>(*attributes, mesh.complex, options);
  }
  void go(int steps, double dt) {
    for (int i = 0; i < steps; ++i, time += dt) dynamics->step(dt, time + dt);
  }
  std::vector<double> rows(const Column& column, const std::vector<Index>& elements) const {
    std::vector<double> values;
    for (const Index e : elements)
      for (const Index v : mesh.complex.vertices_of(e))
        for (int c = 0; c < 3; ++c) values.push_back(column.get(v, c));
    return values;
  }
  std::vector<Index> left, right;
  std::unique_ptr<Dynamics> dynamics;
  double time = 0;
};

DynamicsOptions falling(DynamicsOptions::Scheme scheme) {
  DynamicsOptions options;
  options.scheme = scheme;
  options.gravity = {0, -10, 0};
  return options;
}

TEST(Sleep, OthersMoveTheSameBitsAndSleepersStay) {
  for (const auto scheme :
       {DynamicsOptions::Scheme::symplectic_euler, DynamicsOptions::Scheme::velocity_verlet}) {
    TwoIslands awake(spring_model::defaults(), falling(scheme)),
        half(spring_model::defaults(), falling(scheme));
    for (TwoIslands* body : {&awake, &half}) {
      body->shake(0.01, 3);
      body->dynamics->start();
      body->go(10, 1e-4);
    }
    half.dynamics->sleep(half.left);
    EXPECT_TRUE(half.dynamics->sleeps());
    const auto place = half.rows(half.attributes->position(), half.left);
    const auto force = half.rows(half.attributes->force(), half.left);
    for (TwoIslands* body : {&awake, &half}) body->go(50, 1e-4);
    for (TwoIslands* body : {&awake, &half}) body->dynamics->synchronise();
    for (const auto column : {&Attributes::position, &Attributes::velocity, &Attributes::force})
      EXPECT_EQ(half.rows(((*half.attributes).*column)(), half.right),
                awake.rows(((*awake.attributes).*column)(), awake.right));
    EXPECT_EQ(half.rows(half.attributes->position(), half.left), place);
    EXPECT_EQ(half.rows(half.attributes->force(), half.left), force) << "those of before";
    for (const double v : half.rows(half.attributes->velocity(), half.left)) EXPECT_EQ(v, 0);
    EXPECT_NE(awake.rows(awake.attributes->position(), awake.left), place);
    half.dynamics->wake_all();
    half.dynamics->synchronise();
    EXPECT_NE(half.rows(half.attributes->force(), half.left), std::vector<double>(force.size()));
    half.go(20, 1e-4);
    EXPECT_NE(half.rows(half.attributes->position(), half.left), place);
  }
}

TEST(Sleep, SleepersAreNotComputed) {
  auto parameters = spring_model::defaults();
  const TwoIslands body(parameters, {});
  const auto highest = [&](const std::vector<Index>& elements) {
    Index edge = 0;
    for (const Index e : elements)
      for (const Index i : body.mesh.complex.edges_of(e)) edge = std::max(edge, i);
    return edge;
  };
  // Edges that only one island has fail when they are computed.
  const bool right = highest(body.right) > highest(body.left);
  parameters[spring_model::fail_from] = highest(right ? body.left : body.right) + 1;
  TwoIslands failing(parameters, {});
  failing.dynamics->start();
  EXPECT_THROW(failing.dynamics->step(1e-4, 1e-4), NumericalError);
  failing.dynamics->forces().sleep(right ? failing.right : failing.left);
  EXPECT_NO_THROW(failing.dynamics->step(1e-4, 1e-4));
  failing.dynamics->forces().wake_all();
  EXPECT_THROW(failing.dynamics->step(1e-4, 2e-4), NumericalError);
}

TEST(Sleep, AnyOperationWakes) {
  TwoIslands body(spring_model::defaults(), falling(DynamicsOptions::Scheme::symplectic_euler));
  body.dynamics->start();
  body.dynamics->sleep(body.left);
  body.dynamics->sleep(body.right);  // one after the other
  const auto place = body.rows(body.attributes->position(), body.left);
  body.go(5, 1e-4);
  EXPECT_EQ(body.rows(body.attributes->position(), body.left), place);
  body.dynamics->prepare_change({}, false);
  const TopologyChange change = body.mesh.complex.pierce(std::vector{body.right[0]});
  body.attributes->apply(body.mesh.complex, change);
  body.dynamics->update(body.mesh.complex, change);
  EXPECT_FALSE(body.dynamics->sleeps());
  body.go(5, 1e-4);
  // It has fallen for five steps: v = 5 g dt.
  for (const Index v : body.mesh.complex.vertices_of(body.left[0]))
    EXPECT_NEAR(body.attributes->velocity().get(v, 1), -10 * 5e-4, 1e-12);
}

TEST(Sleep, OnlyWholeIslandsSleep) {
  TwoIslands body(spring_model::defaults(), {});
  body.dynamics->start();
  EXPECT_THROW(body.dynamics->sleep(std::span(body.left).first(3)), InputError);
  EXPECT_THROW(body.dynamics->sleep(std::vector<Index>{9999}), InputError);
  EXPECT_FALSE(body.dynamics->sleeps());
}

/// The motion that a sleep omits, against the header's bound v T + a T^2 / 2.
TEST(Sleep, WhatIsLostStaysBelowTheBound) {
  DynamicsOptions options = falling(DynamicsOptions::Scheme::velocity_verlet);
  TwoIslands body(spring_model::defaults(), options);
  std::vector<Index> held;
  for (const Index e : body.left)
    for (const Index v : body.mesh.complex.vertices_of(e))
      if (body.attributes->rest().get(v, 0) < 1e-9) held.push_back(v);
  body.dynamics->constraints().add(held, 7, {}, *body.attributes);
  body.dynamics->start();
  body.dynamics->set_damping(3);
  body.go(20000, 1e-3);  // hangs nearly still
  body.dynamics->set_damping(0);
  const auto still = body.dynamics->stillness(body.left);
  EXPECT_GT(still.velocity + still.acceleration, 0);
  EXPECT_LT(still.acceleration, 0.1) << "against 10 of gravity";
  EXPECT_NEAR(body.dynamics->stillness(body.right).acceleration, 10, 1e-6) << "it falls";
  const auto before = body.rows(body.attributes->position(), body.left);
  const int steps = 200;
  body.go(steps, 1e-3);
  const double T = steps * 1e-3;
  double squares = 0, mass = 0;
  std::size_t i = 0;
  for (const Index e : body.left)
    for (const Index v : body.mesh.complex.vertices_of(e)) {
      const double m = body.attributes->mass().get(v, 0);
      mass += m;
      for (int c = 0; c < 3; ++c, ++i)
        squares += m * std::pow(body.attributes->position().get(v, c) - before[i], 2);
    }
  const double lost = std::sqrt(squares / mass);
  EXPECT_GT(lost, 0);
  EXPECT_LT(lost, still.velocity * T + still.acceleration * T * T / 2);
}

}  // namespace
