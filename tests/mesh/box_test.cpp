// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/mesh/box.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

TEST(Box, NumbersPointsAndNodesWithXFastest) {
  const Mesh mesh = make_box({.origin = {1, 2, 3}, .size = {2, 3, 4}, .cells = {2, 3, 4}});
  EXPECT_EQ(mesh.source, "box 2 x 3 x 4");
  ASSERT_EQ(mesh.points.size(), 3u * 4 * 5);
  ASSERT_EQ(mesh.hexahedra.size(), 2u * 3 * 4);
  EXPECT_EQ(mesh.points[0], (Vec3{1, 2, 3}));
  EXPECT_EQ(mesh.points[1], (Vec3{2, 2, 3}));
  EXPECT_EQ(mesh.points[3], (Vec3{1, 3, 3}));
  EXPECT_EQ(mesh.points[12], (Vec3{1, 2, 4}));
  EXPECT_EQ(mesh.points.back(), (Vec3{3, 5, 7}));
  // Node X_i of each unit cell lies at its corner (i&1, (i>>1)&1, (i>>2)&1).
  for (std::size_t e = 0; e < mesh.hexahedra.size(); ++e) {
    const Vec3 low{1.0 + e % 2, 2.0 + e / 2 % 3, 3.0 + double(e / 6)};
    for (int i = 0; i < 8; ++i) {
      const Vec3 corner{low[0] + (i & 1), low[1] + (i >> 1 & 1), low[2] + (i >> 2 & 1)};
      EXPECT_EQ(mesh.points[mesh.hexahedra[e][i]], corner) << "element " << e << " node " << i;
    }
  }
}

TEST(Box, SidesAreTheirPoints) {
  const Mesh mesh = make_box({.size = {2, 3, 4}, .cells = {2, 3, 4}});
  ASSERT_EQ(mesh.point_sets.size(), 6u);
  const char* names[3][2] = {{"x0", "x1"}, {"y0", "y1"}, {"z0", "z1"}};
  const double length[3] = {2, 3, 4};
  for (int a = 0; a < 3; ++a) {
    for (int s = 0; s < 2; ++s) {
      std::vector<Index> expected;
      for (Index p = 0; p < mesh.points.size(); ++p) {
        if (mesh.points[p][a] == s * length[a]) expected.push_back(p);
      }
      EXPECT_EQ(mesh.point_sets.at(names[a][s]), expected) << names[a][s];
    }
  }
}

TEST(Box, IsSymmetricToTheBit) {
  for (const double g : {1.0, 1.0 + 1e-15, 3.0, 7.3e3}) {
    const BoxOptions options{.origin = {-0.35, -0.1, -0.7},
                             .size = {0.7, 0.2, 1.4},
                             .cells = {7, 10, 1},
                             .grading = {g, g, g}};
    BoxOptions mirrored = options;
    mirrored.grading = {1 / g, 1 / g, 1 / g};
    const Mesh a = make_box(options), b = make_box(mirrored);
    const std::size_t n = a.points.size();
    for (std::size_t i = 0; i < n; ++i) {
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(a.points[i][c], -b.points[n - 1 - i][c], g == 1 ? 0 : 1e-16);
    }
  }
}

TEST(Box, EndsExactlyWhereAskedAndRoundsOnce) {
  const BoxOptions options{.origin = {0, 0.1, -1e6}, .size = {0.3, 0.7, 1}, .cells = {49, 3, 10}};
  const Mesh mesh = make_box(options);
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(mesh.points.front()[c], options.origin[c]);
    EXPECT_EQ(mesh.points.back()[c], options.origin[c] + options.size[c]);
  }
  for (int i = 0; i <= 49; ++i) EXPECT_DOUBLE_EQ(mesh.points[i][0], 0.3 * i / 49);
}

TEST(Box, GradingIsLastOverFirst) {
  const Mesh mesh = make_box({.size = {1, 1, 1}, .cells = {6, 1, 1}, .grading = {5, 1, 1}});
  const auto width = [&](int i) { return mesh.points[i + 1][0] - mesh.points[i][0]; };
  EXPECT_NEAR(width(5) / width(0), 5, 1e-13);
  for (int i = 1; i < 5; ++i) EXPECT_NEAR(width(i) / width(i - 1), width(i + 1) / width(i), 1e-13);
}

TEST(Box, RefusesWhatIsNoBox) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(make_box({.cells = {3, 0, 3}}), InputError);
  EXPECT_THROW(make_box({.size = {1, -1, 1}}), InputError);
  EXPECT_THROW(make_box({.size = {1, 1, nan}}), InputError);
  EXPECT_THROW(make_box({.origin = {nan, 0, 0}}), InputError);
  EXPECT_THROW(make_box({.grading = {0, 1, 1}}), InputError);
  EXPECT_THROW(make_box({.cells = {4000000000u, 1, 1}}), InputError);
  EXPECT_THROW(make_box({.cells = {1000, 1000, 1000}}), InputError);
  EXPECT_THROW(make_box({.cells = {max_elements + 1, 1, 1}}), InputError);
  EXPECT_THROW(make_box({.origin = {1e16, 0, 0}, .cells = {10, 1, 1}}), InputError);
}

}  // namespace
}  // namespace suture
