// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/clock.hpp"

#include <gtest/gtest.h>

namespace suture {
namespace {

TEST(Clock, FixedStepsDoNotDrift) {
  Clock clock(0.1, {}, 0, 100.0);
  std::uint64_t steps = 0;
  for (; !clock.finished(); ++steps) {
    ASSERT_EQ(clock.next_dt(1e-9), 0.1) << "a fixed dt is the user's word";
    clock.advance();
  }
  EXPECT_EQ(steps, 1000u);
  EXPECT_EQ(clock.time(), 1000 * 0.1);
}

TEST(Clock, FixedStepsServeThingsAtTheNearestStep) {
  Clock clock(0.1, {}, 0, 1.0);
  EXPECT_TRUE(clock.reached(0.0));
  EXPECT_TRUE(clock.reached(0.049));
  EXPECT_FALSE(clock.reached(0.051));
}

TEST(Clock, AutomaticStepsHitEveryStopWithStepsNoLongerThanTheStableOne) {
  const double stable = 0.013;
  Clock clock(std::nullopt, {0.5, 0.31}, 0.25, 1.0);
  std::vector<double> hit;
  const std::vector<double> expected{0.25, 0.31, 0.5, 0.75, 1.0};
  std::size_t next = 0;
  while (!clock.finished()) {
    const double dt = clock.next_dt(stable);
    ASSERT_LE(dt, stable * (1 + 1e-9));
    ASSERT_GT(dt, 0.5 * stable);
    clock.advance();
    if (next < expected.size() && clock.reached(expected[next])) {
      EXPECT_NEAR(clock.time(), expected[next], 1e-12);
      ++next;
    }
  }
  EXPECT_EQ(next, expected.size());
}

TEST(Clock, ANewBoundRedividesTheIntervalInProgress) {
  Clock clock(std::nullopt, {}, 0, 1.0);
  EXPECT_DOUBLE_EQ(clock.next_dt(0.25), 0.25);
  clock.advance();
  EXPECT_DOUBLE_EQ(clock.next_dt(0.1), 0.75 / 8);
}

TEST(Clock, OneMoreStopRedividesTheIntervalAndIsHit) {
  Clock clock(std::nullopt, {}, 0, 1.0);
  EXPECT_DOUBLE_EQ(clock.next_dt(0.25), 0.25);
  clock.advance();
  EXPECT_DOUBLE_EQ(clock.next_dt(0.25, 0.55), 0.15);
  clock.advance();
  EXPECT_DOUBLE_EQ(clock.next_dt(0.25, 0.55), 0.15);
  clock.advance();
  EXPECT_GE(clock.reached_until(), 0.55);
  EXPECT_DOUBLE_EQ(clock.next_dt(0.25), 0.225);
}

TEST(Clock, ARunUntilRestHasNoEnd) {
  Clock clock(std::nullopt, {}, 0, std::nullopt);
  for (int i = 0; i < 3000; ++i) {
    ASSERT_DOUBLE_EQ(clock.next_dt(1e-3), 1e-3);
    clock.advance();
    ASSERT_FALSE(clock.finished());
  }
  EXPECT_NEAR(clock.time(), 3.0, 1e-12);
}

TEST(Clock, FixedStepsAreDividedAtOnceAndWholeAgainLater) {
  Clock clock(0.1, {}, 0, 10.0);
  const auto step = [&] {
    const double dt = clock.next_dt(1), before = clock.time();
    clock.advance();
    EXPECT_NEAR(clock.time() - before, dt, 1e-15);
    return dt;
  };
  for (int i = 0; i < 7; ++i) EXPECT_EQ(step(), 0.1);
  clock.divide(2);
  EXPECT_EQ(step(), 0.1 / 4);
  clock.divide(3);  // a quarter is two eighths
  EXPECT_EQ(step(), 0.1 / 8);
  EXPECT_NEAR(clock.time(), 0.7 + 0.0375, 1e-15);
  clock.divide(1);  // from the next whole step on
  for (int i = 0; i < 5; ++i) EXPECT_EQ(step(), 0.1 / 8);
  EXPECT_EQ(clock.time(), 8 * 0.1);
  EXPECT_EQ(step(), 0.1 / 2);
  clock.divide(0);
  EXPECT_EQ(step(), 0.1 / 2);
  EXPECT_EQ(step(), 0.1);
  EXPECT_EQ(clock.time(), 10 * 0.1);
}

TEST(Clock, ACopyIsATimeToGoBackTo) {
  for (const bool fixed : {false, true}) {
    Clock clock(fixed ? std::optional(0.1) : std::nullopt, {0.35}, 0, 10.0);
    const auto go_on = [&] {
      std::vector<double> times;
      for (int i = 0; i < 20; ++i) {
        clock.next_dt(0.09);
        clock.advance();
        times.push_back(clock.time());
      }
      return times;
    };
    clock.next_dt(0.09);
    clock.advance();
    const Clock kept = clock;
    const std::vector<double> first = go_on();
    clock = kept;
    EXPECT_EQ(clock.step(), 1u);
    EXPECT_EQ(go_on(), first);
  }
}

TEST(Clock, AnEndThatNoRunReachesBeginsWithSteps) {
  Clock clock(std::nullopt, {1e-6}, 0, 1e19);
  double last = 0;
  for (int i = 0; i < 3000; ++i) {
    const double dt = clock.next_dt(1e-3);
    ASSERT_LE(dt, 1e-3 * (1 + 1e-12));
    clock.advance();
    ASSERT_GT(clock.time(), last);
    last = clock.time();
    ASSERT_FALSE(clock.finished());
  }
}

}  // namespace
TEST(Clock, TakesAStepBack) {
  for (const std::optional<double> fixed : {std::optional<double>(0.1), std::optional<double>()}) {
    Clock clock(fixed, {}, 0, 1.0);
    clock.divide(fixed ? 1 : 0);
    for (int i = 0; i < 5; ++i) {
      clock.next_dt(0.03);
      clock.advance();
      const double time = clock.time();
      clock.next_dt(0.03);
      clock.advance();
      clock.undo_advance();
      EXPECT_EQ(clock.time(), time);
      EXPECT_EQ(clock.step(), static_cast<std::uint64_t>(i + 1));
    }
  }
}

}  // namespace suture
