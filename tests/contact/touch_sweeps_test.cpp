// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/touch_sweeps.hpp"

#include <gtest/gtest.h>

namespace suture {
namespace {

/// A vertex of 1 kg that approaches a held face at 1 m/s.
TEST(TouchSweeps, ImproveWhatOthersHaveMoved) {
  std::vector<double> velocities(4 * 5);
  velocities[2] = -1;
  PieceTouch touch{};
  touch.vertices = {0, 1, 2, 3, 4};
  touch.weights = {1, -0.25, -0.25, -0.25, -0.25};
  touch.response = {1, 0, 0, 0, 0};
  touch.normal = {0, 0, 1};
  touch.mass = 1;
  const double dt = 0.1;
  TouchSweeps sweeps;
  sweeps.begin({&touch, 1});
  const auto sweep = [&] { return sweeps.sweep({&touch, 1}, velocities.data(), 0, dt, 0.01); };
  EXPECT_EQ(sweep(), dt);
  EXPECT_EQ(velocities[2], 0);
  velocities[2] = -0.5;
  sweeps.disturb(0, 0.006);
  EXPECT_EQ(sweep(), 0) << "less than is worth a look";
  sweeps.disturb(0, 0.006);
  EXPECT_EQ(sweep(), 0.5 * dt) << "both add up";
  EXPECT_EQ(velocities[2], 0);
  EXPECT_EQ(touch.impulse, 1.5);
}

}  // namespace
}  // namespace suture
