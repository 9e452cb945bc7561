// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/spectrum/step_limits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/forces/spring_model.hpp"

namespace {

using namespace suture;
using namespace spring_model;
using spring_model::Body;

TEST(StepLimits, BoundsAreSummedPerVertexAndLookAtFreeComponents) {
  Body body(box(2, 1, 1));
  auto parameters = defaults();
  parameters[diagonal_stiffness] = 0;
  parameters[edge_damping] = 2;
  body.add(parameters);
  body.compile(1);
  // A vertex in the middle: 3 edges of one, 1 of two elements... summed: factors
  // 1/4 per element, so 2 k (1/4 + 1/4 + 2/4 + 2/4) over a mass of two shares.
  StepLimits limits(body);
  const double share = 1000 * 1e-3 / 8;
  auto bounds = limits.bounds(0);
  EXPECT_NEAR(bounds.stiffness, 2 * 100 * 0.75 / share, 1e-9 * bounds.stiffness);
  EXPECT_NEAR(bounds.damping, 2 * 2 * 3 / share, 1e-9 * bounds.damping);
  for (Index v = 0; v < 12; ++v) body.attributes().fixed().set(v, 0, 7);
  bounds = limits.bounds(0);
  EXPECT_EQ(bounds.stiffness, 0);
  EXPECT_TRUE(std::isinf(bounds.dt));
}

TEST(StepLimits, BoundsAroundVerticesAreTheirsAmongAll) {
  Worn worn;
  StepLimits limits(worn);
  const Index vertices = worn.attributes().vertex_count();
  worn.attributes().fixed().set(0, 0, 7);
  worn.attributes().fixed().set(1, 0, 2);
  std::vector<StepBounds> single;
  StepBounds largest;
  for (Index v = 0; v < vertices; ++v) {
    single.push_back(limits.bounds_at({&v, 1}, 0));
    if (single[v].dt < largest.dt) largest = single[v];
  }
  const StepBounds all = limits.bounds(0);
  EXPECT_NEAR(largest.dt, all.dt, 1e-13 * all.dt);
  EXPECT_TRUE(std::isinf(single[0].dt)) << "held";
  std::mt19937 random(3);
  for (int round = 0; round < 20; ++round) {
    std::vector<Index> some;
    double dt = std::numeric_limits<double>::infinity();
    for (Index v = 0; v < vertices; ++v)
      if (random() % 16 == 0) some.push_back(v);
    for (const Index v : some) dt = std::min(dt, single[v].dt);
    const auto bounds = limits.bounds_at(some, 0);
    EXPECT_NEAR(bounds.dt, dt, 1e-13 * dt);
    EXPECT_NEAR(single[bounds.vertex].dt, dt, 1e-13 * dt);
  }
}

}  // namespace
