// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/motion_sums.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace suture {
namespace {

/// Oscillators x'' = -w^2 x of mass m, one per chunk, made step by step as a run does.
struct Oscillators {
  explicit Oscillators(std::vector<double> frequencies)
      : omega(std::move(frequencies)), x(omega.size(), 1), v(omega.size(), 0) {
    sums.resize(static_cast<Index>(omega.size()) * MotionSums::chunk);
  }
  void step(double dt, double last) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double a = -omega[i] * omega[i] * x[i];
      const double after = v[i] + (last > 0 ? (last + dt) / 2 : dt / 2) * a;
      loops::PassSums pass{};
      pass.before = mass * a * v[i];
      pass.after = mass * a * after;
      pass.inertia = mass * after * after;
      if (last > 0) sums.note_before(i, pass, {});
      sums.note_after(i, pass, {});
      v[i] = after;
      x[i] += dt * after;
    }
    sums.finish_step(last > 0 ? last : dt, dt, false);
  }
  static constexpr double mass = 3;
  std::vector<double> omega, x, v;
  MotionSums sums;
};

TEST(MotionSums, FindTheFrequencyOfAnOscillatorExactly) {
  Oscillators o({7});
  o.step(0.01, 0);
  EXPECT_EQ(o.sums.apparent_frequency(), 0) << "one step has no frequency";
  for (int i = 0; i < 50; ++i) {
    o.step(0.01, 0.01);
    ASSERT_NEAR(o.sums.apparent_frequency(), 7 * 0.01, 1e-9) << i;
  }
}

TEST(MotionSums, UseTheStepThatMadeTheMotionWhereItsLengthChanges) {
  Oscillators o({7});
  o.step(0.01, 0);
  o.step(0.02, 0.01);
  EXPECT_NEAR(o.sums.apparent_frequency(), 7 * 0.01, 1e-12);
  o.step(0.005, 0.02);
  EXPECT_NEAR(o.sums.apparent_frequency(), 7 * 0.02, 1e-12);
}

TEST(MotionSums, ReachTwoWhereTheStepIsUnstableHoweverMuchElseMoves) {
  Oscillators o({1, 1, 201, 1});  // h w = 0.01, and 2.01 in the third chunk
  o.step(0.01, 0);
  for (int i = 0; i < 20; ++i) o.step(0.01, 0.01);
  EXPECT_NEAR(o.sums.apparent_frequency(), 2.01, 1e-9);
  EXPECT_EQ(o.sums.fastest_chunk(), 2u);
}

TEST(MotionSums, LookAtTheWholeBodyOnceAfterVerticesWereSplit) {
  Oscillators o({7, 7});
  o.step(0.01, 0);
  o.step(0.01, 0.01);
  o.sums.forget_chunks();
  o.step(0.01, 0.01);
  EXPECT_EQ(o.sums.fastest_chunk(), none);
  EXPECT_NEAR(o.sums.apparent_frequency(), 0.07, 1e-9);
  o.step(0.01, 0.01);
  EXPECT_NE(o.sums.fastest_chunk(), none) << "chunk by chunk again";
}

TEST(MotionSums, HaveNoFrequencyAfterAJumpAndBelowRounding) {
  Oscillators o({7});
  o.step(0.01, 0);
  o.sums.forget_last();
  o.step(0.01, 0.01);
  EXPECT_EQ(o.sums.apparent_frequency(), 0);
  o.step(0.01, 0.01);
  EXPECT_GT(o.sums.apparent_frequency(), 0);
  o.sums.set_noise(1);  // far above C h^2
  o.step(0.01, 0.01);
  EXPECT_EQ(o.sums.apparent_frequency(), 0);
}

// Half-step kinetic energies change by exactly the work of the trapezoid over their interval.
TEST(MotionSums, SumTheWorkOfTheTrapezoid) {
  Oscillators o({7});
  double dt = 0.01, last = 0, expected = 0, a = -49, v = 0;
  for (int i = 0; i < 30; ++i) {
    const double x = o.x[0];
    a = -49 * x;
    expected += last / 2 * Oscillators::mass * a * v;
    o.step(dt, last);
    v = o.v[0];
    expected += dt / 2 * Oscillators::mass * a * v;
    ASSERT_NEAR(o.sums.work(), expected, 1e-12) << i;
    last = dt;
    dt = i % 2 ? 0.01 : 0.015;
  }
  EXPECT_GT(o.sums.work(), 1) << "a test of numbers that are not zero";
}

}  // namespace
}  // namespace suture
