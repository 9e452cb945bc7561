// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/mesh/own_origin.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "kernel/base/error.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/mesh/voxels.hpp"

namespace suture {
namespace {

constexpr Vec3 far_away{1e7, -3e6, 1e5};

TEST(OwnOrigin, OfBoxesAndVoxelsLeavesThePointsOfOnesAtZero) {
  const BoxOptions box{far_away, {1, 0.3, 0.1}, {7, 3, 2}, {2, 1, 0.3}};
  BoxOptions at_zero = box;
  at_zero.origin = {};
  const Mesh local = make_local_box(box);
  EXPECT_EQ(local.points, make_box(at_zero).points);
  EXPECT_EQ(local.origin, far_away);
  EXPECT_EQ(make_box(box).origin, Vec3{}) << "points are those of the scene";

  const VoxelOptions voxels{far_away, 0.1, 2, {"A.", "##"}};
  EXPECT_EQ(make_local_voxels(voxels).points, make_voxels({{}, 0.1, 2, {"A.", "##"}}).points);
  EXPECT_EQ(make_local_voxels(voxels).origin, far_away);
}

TEST(OwnOrigin, OfABoxWhoseCellsVanishInTheSceneIsRefused) {
  EXPECT_THROW(make_local_box({.origin = {1e16, 0, 0}, .cells = {10, 1, 1}}), InputError);
}

TEST(OwnOrigin, IsTheLowerCornerOfWhatElementsUse) {
  Mesh mesh = make_box({.origin = {8, -4, 0.5}, .size = {2, 1, 1}, .cells = {2, 1, 1}});
  mesh.points.push_back({-1e9, 0, 0});  // used by no element
  const Mesh before = mesh;
  move_to_own_origin(mesh);
  EXPECT_EQ(mesh.origin, (Vec3{8, -4, 0.5}));
  EXPECT_EQ(box_of(mesh).low, Vec3{});
  EXPECT_EQ(box_of(mesh).high, (Vec3{2, 1, 1}));
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a)
      EXPECT_EQ(mesh.points[i][a] + mesh.origin[a], before.points[i][a]);
}

TEST(OwnOrigin, AtZeroChangesNoBit) {
  Mesh mesh = make_box({.size = {1, 1, 1}, .cells = {3, 3, 3}});
  mesh.points[0][1] = -0.0;
  move_to_own_origin(mesh);
  EXPECT_TRUE(std::signbit(mesh.points[0][1]));
  EXPECT_EQ(mesh.origin, Vec3{});
}

// The import says what is wrong with these.
TEST(OwnOrigin, OfAMeshThatIsWrongIsLeftAlone) {
  Mesh empty;
  move_to_own_origin(empty);
  EXPECT_EQ(empty.origin, Vec3{});
  Mesh infinite = make_box({.origin = {1, 1, 1}});
  infinite.points[0][0] = -std::numeric_limits<double>::infinity();
  move_to_own_origin(infinite);
  EXPECT_EQ(infinite.points[1][1], 1);
  Mesh out_of_range = make_box({.origin = {1, 1, 1}});
  out_of_range.hexahedra[0][7] = 99;
  move_to_own_origin(out_of_range);
  EXPECT_EQ(out_of_range.origin, (Vec3{1, 1, 1}));
}

}  // namespace
}  // namespace suture
