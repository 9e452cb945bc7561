// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/time_ramp.hpp"

#include <gtest/gtest.h>

namespace suture {
namespace {

TEST(TimeRamp, RisesFromZeroToOne) {
  const TimeRamp step{}, linear{1, 3, false}, smooth{1, 3, true};
  EXPECT_EQ(step.value(0), 1);
  EXPECT_EQ(linear.value(0.5), 0);
  EXPECT_EQ(linear.value(1.5), 0.25);
  EXPECT_EQ(linear.value(4), 1);
  EXPECT_EQ(smooth.value(2), 0.5);
  EXPECT_EQ(smooth.value(1.5), 0.15625);
}

TEST(TimeRamp, RateIsTheDerivativeOfTheValue) {
  for (const bool smooth : {false, true}) {
    const TimeRamp ramp{1, 3, smooth};
    for (const double t : {0.5, 1.3, 2.0, 2.9, 3.5}) {
      const double h = 1e-6, difference = (ramp.value(t + h) - ramp.value(t - h)) / (2 * h);
      EXPECT_NEAR(ramp.rate(t), difference, 1e-9) << "smooth " << smooth << " t " << t;
    }
  }
}

}  // namespace
}  // namespace suture
