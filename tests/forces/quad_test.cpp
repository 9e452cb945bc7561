// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/quad.hpp"

#include <gtest/gtest.h>

#include <random>

namespace suture {
namespace {

/// The integral of the normal over any surface inside a closed line is half of the sum of the cross
/// products of its corners.
TEST(Quad, TheNormalsOfAWarpedFaceSumToTheAreaVectorOfItsEdge) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> offset(-0.3, 0.3);
  Quad x{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
  for (Vec3& corner : x)
    for (double& c : corner) c += offset(random);
  Vec3 sum{}, expected{};
  for_each_point(x, [&](const QuadPoint& point) {
    double total = 0;
    for (const double n : point.n) total += n;
    EXPECT_NEAR(total, 1, 1e-15);
    sum = plus(sum, scaled(0.25, point.normal()));
  });
  for (std::size_t i = 0; i < 4; ++i)
    expected = plus(expected, scaled(0.5, cross(x[i], x[(i + 1) % 4])));
  EXPECT_LT(norm(minus(sum, expected)), 1e-15);
}

}  // namespace
}  // namespace suture
