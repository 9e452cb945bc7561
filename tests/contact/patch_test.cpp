// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/patch.hpp"

#include <gtest/gtest.h>

#include <random>

#include "kernel/base/rows.hpp"
#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

Vec3 foot_of(const Patch& patch, const Patch::Foot& foot) {
  Vec3 place{};
  for (std::size_t i = 0; i < 4; ++i)
    place = plus(place, scaled(foot.weights[i], patch.corners[i]));
  return place;
}

/// To a fine grid of points on the patch.
double distance_by_samples(const Patch& patch, const Vec3& place) {
  constexpr int n = 200;
  double least = 1e9;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) {
      const double r = double(i) / n, s = double(j) / n;
      const Patch::Foot at{{(1 - r) * (1 - s), r * (1 - s), r * s, (1 - r) * s}, {}, {}};
      least = std::min(least, norm(minus(place, foot_of(patch, at))));
    }
  return least;
}

TEST(Patch, FindsTheNearestPointOfWarpedFaces) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> warp(-0.15, 0.15), beside(-0.3, 1.3), off(-0.3, 0.3);
  for (int i = 0; i < 100; ++i) {
    Patch patch{{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}};
    for (Vec3& corner : patch.corners)
      for (double& c : corner) c += warp(random);
    const Vec3 place{beside(random), beside(random), off(random)};
    const Patch::Foot foot = patch.foot(place);
    EXPECT_NEAR(foot.weights[0] + foot.weights[1] + foot.weights[2] + foot.weights[3], 1, 1e-14);
    EXPECT_LT(norm(minus(plus(foot_of(patch, foot), foot.offset), place)), 1e-14);
    const double found = norm(foot.offset);
    EXPECT_LT(found, distance_by_samples(patch, place) + 0.01);
    EXPECT_GT(foot.normal[2], 0.7);
  }
}

TEST(Patch, IsExactOnFlatFaces) {
  const Patch patch{{{{0, 0, 1}, {2, 0, 1}, {2, 1, 1}, {0, 1, 1}}}};
  const Patch::Foot inside = patch.foot({0.5, 0.25, 0.9});
  EXPECT_LT(norm(minus(inside.offset, {0, 0, -0.1})), 1e-15);
  EXPECT_NEAR(inside.weights[0], 0.75 * 0.75, 1e-15);
  const Patch::Foot beside = patch.foot({3, 0.25, 1});
  EXPECT_LT(norm(minus(beside.offset, {1, 0, 0})), 1e-15);
}

/// Eleven faces with a vertex each: a batch of eight, and three.
TEST(Patch, FindsFeetInBatchesAsOneByOne) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  std::vector<double> positions(4 * 55);
  for (double& c : positions) c = coordinate(random);
  std::vector<BoundarySurface::Corners> corners;
  std::vector<NearPair> pairs;
  for (Index face = 0; face < 11; ++face) {
    corners.push_back({5 * face, 5 * face + 1, 5 * face + 2, 5 * face + 3});
    pairs.push_back({5 * face + 4, face});
  }
  std::vector<FaceFoot> feet;
  find_feet(positions.data(), corners, pairs, feet);
  ASSERT_EQ(feet.size(), 11u);
  for (Index i = 0; i < 11; ++i) {
    Patch patch;
    for (std::size_t c = 0; c < 4; ++c) patch.corners[c] = row(positions.data(), corners[i][c]);
    const Patch::Foot foot = patch.foot(row(positions.data(), pairs[i].vertex));
    EXPECT_EQ(Patch::weights_at(feet[i].r, feet[i].s), foot.weights) << i;
    EXPECT_EQ(feet[i].normal, foot.normal) << i;
    EXPECT_EQ(feet[i].gap, dot(foot.offset, foot.normal)) << i;
    EXPECT_EQ(feet[i].distance, norm(foot.offset)) << i;
  }
}

/// Warped and narrow faces: what find_planes() says of them leaves out no vertex that touches.
TEST(FacePlanes, ReachAllThatMayTouch) {
  constexpr double depth = 0.3, most_beside = 0.05;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> warp(-0.2, 0.2), around(-0.5, 1.5), off(-0.4, 0.4);
  std::size_t touching = 0;
  double fullest = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const double width = 0.4 + 0.6 * (trial % 4) / 3;
    std::vector<double> positions;
    std::vector<BoundarySurface::Corners> corners;
    std::vector<NearPair> pairs;
    for (Index face = 0; face < 11; ++face) {  // a batch of eight, and three
      for (const auto& [x, y] : {std::pair{0., 0.}, {1., 0.}, {1., width}, {0., width}})
        positions.insert(positions.end(),
                         {x + warp(random), y + warp(random) * width, warp(random), 0});
      positions.insert(positions.end(), {around(random), around(random) * width, off(random), 0});
      corners.push_back({5 * face, 5 * face + 1, 5 * face + 2, 5 * face + 3});
      pairs.push_back({5 * face + 4, face});
    }
    std::vector<FacePlane> planes;
    std::vector<Vec3> areas;
    std::vector<FaceFoot> feet;
    find_planes(positions.data(), corners, depth, most_beside, planes, areas);
    find_feet(positions.data(), corners, pairs, feet);
    for (Index i = 0; i < 11; ++i) {
      const FacePlane& plane = planes[i];
      const auto from_centre = [&](Index v) {
        return minus(row(positions.data(), v), plane.centre);
      };
      for (const Index corner : corners[i])
        EXPECT_NEAR(std::abs(dot(from_centre(corner), plane.normal)), plane.height, 1e-14);
      if (feet[i].distance > depth || feet[i].beside > most_beside) continue;
      ++touching;
      const Vec3 arm = from_centre(pairs[i].vertex);
      const double height = dot(arm, plane.normal), aside = dot(arm, arm) - height * height;
      EXPECT_LE(aside, plane.reach) << "trial " << trial << ", face " << i;
      EXPECT_LE(-height, plane.height + depth);
      fullest = std::max(fullest, aside / plane.reach);
    }
  }
  EXPECT_GT(touching, 500u);
  EXPECT_GT(fullest, 0.8) << "the bound is of use";
}

}  // namespace
}  // namespace suture
