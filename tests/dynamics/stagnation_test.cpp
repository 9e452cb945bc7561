// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/stagnation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace suture;

// x'' + alpha x' + w^2 x = 0: the slower root of s^2 - alpha s + w^2.
TEST(SlowRate, IsThatOfADampedOscillator) {
  EXPECT_DOUBLE_EQ(slow_rate(3, 4), 2);
  EXPECT_DOUBLE_EQ(slow_rate(3, 6), 3) << "critical";
  EXPECT_NEAR(slow_rate(3, 10), 1, 1e-14) << "s^2 - 10 s + 9 = (s - 1)(s - 9)";
  EXPECT_DOUBLE_EQ(slow_rate(3, 0), 0.03) << "what viscous forces add";
  EXPECT_DOUBLE_EQ(slow_rate(0, 0), 0);
}

/// Steps of 0.01 s, checked every tenth, until the search stagnates; 0 if it never does.
template <class Distance>
std::uint64_t stagnates_after(Distance distance, double rate) {
  Stagnation stagnation;
  for (std::uint64_t step = 10; step <= 1'000'000; step += 10) {
    const double time = 0.01 * static_cast<double>(step);
    stagnation.add(step, time, distance(time), rate);
    if (stagnation.stagnates()) return step;
  }
  return 0;
}

TEST(Stagnation, ADistanceThatFallsAtThe28thPartOfTheRateIsProgress) {
  EXPECT_EQ(stagnates_after([](double t) { return 1e9 * std::exp(-t / 28); }, 1), 0u);
  EXPECT_NE(stagnates_after([](double t) { return 1e9 * std::exp(-t / 30); }, 1), 0u);
}

TEST(Stagnation, AFloorIsFoundAfterItsPatience) {
  const auto floor = [](double t) { return std::max(1e6 * std::exp(-t), 10.0); };
  const double reached = std::log(1e5);  // s
  const double found = 0.01 * static_cast<double>(stagnates_after(floor, 1));
  EXPECT_GT(found, reached + Stagnation::patience * Stagnation::window_decays - 1);
  EXPECT_LT(found, reached + (Stagnation::patience + 1) * Stagnation::window_decays + 1);
}

TEST(Stagnation, ACycleIsNoProgress) {
  EXPECT_NE(stagnates_after([](double t) { return 100 * (1.5 + std::sin(t)); }, 1), 0u);
}

// It leaves an unstable state: the residual grows through six decades, then falls.
TEST(Stagnation, ABodyThatBucklesIsOnItsWay) {
  const auto buckles = [](double t) {
    return t < 300 ? std::exp(-t) + 1e-6 * std::exp(t / 10) : 1e7 * std::exp(300 - t);
  };
  EXPECT_EQ(stagnates_after(buckles, 1), 0u);
}

TEST(Stagnation, RestartForgetsTheRecord) {
  Stagnation stagnation;
  for (std::uint64_t step = 10; !stagnation.stagnates(); step += 10)
    stagnation.add(step, 0.01 * static_cast<double>(step), 5, 1);
  EXPECT_EQ(stagnation.best(), 5);
  stagnation.restart();
  EXPECT_FALSE(stagnation.stagnates());
  EXPECT_EQ(stagnation.steps_without_progress(), 0u);
}

}  // namespace
