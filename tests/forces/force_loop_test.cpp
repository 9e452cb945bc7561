// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/force_loop.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstdlib>
#include <cstring>

#include "kernel/base/isa.hpp"
#include "tests/base/sanitizer.hpp"
#include "tests/base/variable.hpp"
#include "tests/forces/spring_model.hpp"

namespace {

using namespace suture;
using namespace spring_model;
using spring_model::Body;

/// Every instruction set that this processor has.
class OnIsa : public testing::TestWithParam<const char*> {
 protected:
  const suture::test::Variable isa_{"SUTURE_ISA", GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Sets, OnIsa, testing::Values("base", "avx2", "avx512"));

TEST_P(OnIsa, ForcesAreThoseOfOneCellAtATime) {
  Body body(box(5, 4, 3), true);
  auto parameters = defaults();
  parameters[edge_damping] = 3;
  Instance& instance = body.add(parameters);
  body.compile(1);
  body.shake(0.02, 1);
  ForceLoop& loop = body.models();
  const std::string_view isa = best_isa();
  EXPECT_EQ(loop.isa(), isa.empty() ? "base" : isa);
  EXPECT_GT(instance.general_begin % 8, 0u) << "one block is to hold both shapes";
  EXPECT_LT(largest_difference(forces_of(body, loop), reference_forces(body, instance)), 1e-13);
}

TEST_P(OnIsa, CutsKeepThemSo) {
  Body body(box(6, 5, 4), true);
  Instance& instance = body.add(defaults());
  body.compile(1);
  ForceLoop& loop = body.models();
  for (unsigned seed = 1; seed <= 12; ++seed) {
    body.cut_random(12, seed);
    body.shake(0.02, seed);
    EXPECT_LT(largest_difference(forces_of(body, loop), reference_forces(body, instance)), 1e-13)
        << "seed " << seed;
  }
}

TEST(ForceLoop, TwoInstancesShareTheVerticesBetweenThem) {
  Body body(box(6, 3, 3));
  std::vector<Index> left, right;
  for (Index e = 0; e < body.complex().element_count(); ++e)
    (body.imported().user_element[e] % 6 < 3 ? left : right).push_back(e);
  Instance& first = body.add(defaults(), left);
  auto soft = defaults();
  soft[edge_stiffness] = 7;
  Instance& second = body.add(soft, right);
  body.compile(1);
  ForceLoop& loop = body.models();
  for (unsigned seed = 1; seed <= 5; ++seed) {
    body.shake(0.02, seed);
    auto expected = reference_forces(body, first);
    const auto more = reference_forces(body, second);
    for (std::size_t v = 0; v < expected.size(); ++v)
      for (std::size_t c = 0; c < 3; ++c) expected[v][c] += more[v][c];
    EXPECT_LT(largest_difference(forces_of(body, loop), expected), 1e-13);
    body.cut_random(10, seed);
  }
}

TEST(ForceLoop, SameBitsForAnyNumberOfThreads) {
  // More threads than processors, too.
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  std::vector<double> one;
  double energy = 0;
  for (const unsigned threads : test::thread_counts()) {
    Body body(box(24, 20, 20));
    body.add(defaults());
    body.compile(threads);
    ForceLoop& loop = body.models();
    EXPECT_EQ(loop.threads(), threads);
    body.shake(0.02, 3);
    forces_of(body, loop);
    body.cut_random(300, 5);
    body.shake(0.02, 4);
    const auto forces = forces_of(body, loop);
    if (threads == 1) {
      one = forces;
      energy = loop.energy(0);
    }
    EXPECT_EQ(std::memcmp(one.data(), forces.data(), one.size() * sizeof(double)), 0) << threads;
    EXPECT_EQ(energy, loop.energy(0)) << threads;
  }
}

TEST(ForceLoop, SmallLoopsRunOnOneThread) {
  Body body(box(4, 4, 4));
  body.add(defaults());
  body.compile(8);
  EXPECT_EQ(body.models().threads(), 1u);
}

TEST(ForceLoop, TheLowestCellIsReportedWhateverTheThreadsDo) {
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 8);
  for (const unsigned threads : {1u, 2u, 8u}) {
    Body body(box(24, 20, 20));
    auto parameters = defaults();
    parameters[fail_from] = 1003;
    body.add(parameters);
    body.compile(threads);
    ForceLoop& loop = body.models();
    try {
      loop.add_forces(0.25, 0);
      FAIL() << "no error";
    } catch (const NumericalError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find("cell 1005 says no"), std::string::npos) << text;
      EXPECT_NE(text.find("edge 1005"), std::string::npos) << text;
      EXPECT_NE(text.find("'edges'"), std::string::npos) << text;
      EXPECT_NE(text.find("0.25"), std::string::npos) << text;
    }
  }
}

TEST(ForceLoop, AModelMayAskForASmallerStep) {
  Body body(box(4, 4, 4));
  auto parameters = defaults();
  parameters[fail_from] = 10;
  parameters[fail_how] = 1;
  body.add(parameters);
  body.compile(1);
  ForceLoop& loop = body.models();
  try {
    loop.add_forces(0, 0.1);
    FAIL() << "no error";
  } catch (const StepRejected& rejected) {
    EXPECT_EQ(rejected.step_factor, 0.25);  // cell 15; cells 10 and 20 propose 0.5
  }
}

TEST(ForceLoop, SkipsWhatGivesNoForce) {
  Body body(box(4, 4, 4));
  auto parameters = defaults();
  parameters[diagonal_stiffness] = 0;
  body.add(parameters);
  body.compile();
  const auto lines = body.models().summary();
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_FALSE(lines[0].skipped);
  EXPECT_EQ(lines[0].cells, body.complex().count(1));
  EXPECT_EQ(lines[0].reads & SUTURE_READ_VELOCITY, 0u) << "no damping, no velocities";
  EXPECT_TRUE(lines[1].skipped);
  EXPECT_TRUE(lines[2].skipped);
}

// Springs without stiffness, on edges or inside: neither run nor stored, edges not
// even numbered, before cuts and after; computed all the same they change no bit.
TEST(ForceLoop, WhatGivesNoForceChangesNoBit) {
  for (const int off : {edge_stiffness, diagonal_stiffness}) {
    const bool edges = off == edge_stiffness;
    std::vector<double> forces[2];
    for (const bool skip : {true, false}) {
      Body body(box(6, 5, 4));
      auto parameters = defaults();
      parameters[static_cast<std::size_t>(off)] = 0;
      const Instance& instance = body.add(parameters, {}, skip);
      body.compile(1);
      EXPECT_EQ(body.complex().has_edges(), !(edges && skip));
      EXPECT_EQ(instance.column(edges ? 1 : 2) == nullptr, skip);
      ForceLoop& loop = body.models();
      for (const auto& line : loop.summary())
        EXPECT_EQ(line.skipped,
                  line.functor == "others" || (skip && (line.functor == "edges") == edges))
            << line.functor << ": " << line.reason;
      body.cut_random(12, 1);
      body.shake(0.02, 3);
      forces[skip] = forces_of(body, loop);
    }
    EXPECT_GT(*std::max_element(forces[0].begin(), forces[0].end()), 0.1);
    EXPECT_TRUE(forces[0] == forces[1]);
  }
}

TEST(ForceLoop, EnergyHasTheForcesAsGradient) {
  Body body(box(3, 3, 3));
  auto parameters = defaults();
  parameters[diagonal_stiffness] = 0;  // has no energy extension
  Instance& instance = body.add(parameters);
  body.compile(1);
  body.shake(0.02, 9);
  ForceLoop& loop = body.models();
  EXPECT_NEAR(loop.energy(0), reference_energy(body, instance), 1e-13 * loop.energy(0));
  const auto forces = forces_of(body, loop);
  Column& x = body.attributes().position();
  for (const Index v : {Index{0}, Index{13}, Index{41}}) {
    const double here = x.get(v, 1), h = 1e-6;
    x.set(v, 1, here + h);
    const double above = loop.energy(0);
    x.set(v, 1, here - h);
    const double below = loop.energy(0);
    x.set(v, 1, here);
    ASSERT_GT(std::abs(forces[4 * v + 1]), 1e-3);
    EXPECT_NEAR(-(above - below) / (2 * h), forces[4 * v + 1], 1e-6);
  }
}

}  // namespace
