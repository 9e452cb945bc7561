// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/clip.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "kernel/base/vec3.hpp"
#include "kernel/parts/moments.hpp"

namespace suture {
namespace {

Box cube(std::size_t number, double edge) {
  const Vec3 low{edge * double(number % 4), edge * double(number / 4 % 4),
                 edge * double(number / 16)};
  return {low, plus(low, {edge, edge, edge})};
}

// Corners on planes of the lattice are among them.
TEST(Clip, CubesDivideATetrahedron) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> place(0, 12);
  for (int round = 0; round < 2000; ++round) {
    std::array<Vec3, 4> t;
    std::vector<Vec3> face;
    for (Vec3& corner : t)
      for (double& x : corner) x = round % 2 == 0 ? place(random) / 12.0 : random() / 4294967296.0;
    for (std::size_t i = 0; i < 3; ++i) face.push_back(t[i]);
    double sum = 0;
    for (std::size_t c = 0; c < 64; ++c) {
      const double volume = volume_within(t, cube(c, 0.25));
      EXPECT_GE(volume, 0);
      EXPECT_LE(volume, 1.0 / 64 + 1e-15);
      sum += volume;
    }
    EXPECT_NEAR(sum, std::abs(six_volumes(t)) / 6, 1e-14) << "round " << round;
  }
}

TEST(Clip, APolygonMeetsTheBoxesThatItCrosses) {
  const std::vector<Vec3> triangle{{0.1, 0.1, 0.3}, {0.85, 0.1, 0.3}, {0.1, 0.85, 0.3}};
  for (std::size_t c = 0; c < 64; ++c) {
    const Box box = cube(c, 0.25);
    const bool crosses = box.low[2] == 0.25 && box.low[0] + box.low[1] < 1;
    EXPECT_EQ(meets(triangle, box), crosses) << c;
  }
}

}  // namespace
}  // namespace suture
