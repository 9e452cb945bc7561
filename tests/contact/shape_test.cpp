// SPDX-License-Identifier: GPL-3.0-or-later
//
// Distances and normals of the shapes, and where a path takes them.
#include "kernel/geometry/shape.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <random>

#include "kernel/base/rows.hpp"
#include "kernel/geometry/obstacle.hpp"
#include "kernel/geometry/shape_mesh.hpp"
#include "kernel/geometry/solid_surface.hpp"
#include "tests/geometry/surfaces.hpp"

namespace suture {
namespace {

const std::vector<Shape>& shapes() {
  static const std::vector<Shape> all{HalfSpace{{0.1, 0.2, -0.3}, {0.6, 0, 0.8}},
                                      Sphere{{0.1, -0.2, 0.3}, 0.7},
                                      Capsule{{-0.4, 0, 0.1}, {0.5, 0.3, -0.2}, 0.35},
                                      Box{{-0.5, -0.4, -0.3}, {0.6, 0.2, 0.4}},
                                      Cylinder{{-0.4, 0.1, 0}, {0.5, -0.3, 0.2}, 0.4},
                                      Triangulated{std::make_shared<SolidSurface>(test::box_surface(
                                                       {-0.5, -0.4, -0.3}, {0.6, 0.2, 0.4})),
                                                   {0.1, 0, 0.2}}};
  return all;
}

class AllShapes : public testing::TestWithParam<std::size_t> {
 protected:
  const Shape& shape() const { return shapes()[GetParam()]; }
};
INSTANTIATE_TEST_SUITE_P(Shapes, AllShapes, testing::Range(std::size_t{0}, shapes().size()),
                         [](const auto& test) { return name_of(shapes()[test.param]); });

TEST_P(AllShapes, TheNormalLeadsToTheSurfaceAndTheDistanceIsItsLength) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> coordinate(-1.5, 1.5);
  int inside = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 place{coordinate(random), coordinate(random), coordinate(random)};
    const Nearest found = nearest(shape(), place);
    inside += found.distance < 0;
    EXPECT_NEAR(norm(found.normal), 1, 1e-14);
    const Vec3 foot = minus(place, scaled(found.distance, found.normal));
    EXPECT_NEAR(nearest(shape(), foot).distance, 0, 1e-14);
    // Nothing nearer: a distance never changes faster than the place.
    const Vec3 other{coordinate(random), coordinate(random), coordinate(random)};
    EXPECT_LE(std::abs(nearest(shape(), other).distance - found.distance),
              norm(minus(other, place)) + 1e-14);
  }
  EXPECT_GT(inside, 5);
  EXPECT_LT(inside, 900);
}

TEST_P(AllShapes, DisplayedSurfacesLieOnThem) {
  const ShapeMesh mesh = mesh_of(shape(), {}, 1);
  for (const Vec3& point : mesh.points) {
    EXPECT_NEAR(nearest(shape(), point).distance, 0, 1e-14);
    EXPECT_LE(norm(minus(point, ball_around(shape()).centre)),
              ball_around(shape()).radius * (1 + 1e-14));
  }
  for (const Vec3& point : points_inside(shape()))
    EXPECT_LE(nearest(shape(), point).distance, 1e-14);
}

TEST(RigidPath, IsLinearBetweenStationsAndRestsOutside) {
  RigidPath path;
  path.stations = {{1, {0, 0, 0}, 0}, {2, {1, 0, 0}, std::numbers::pi / 2}, {4, {1, 0, 2}, 0}};
  path.centre = {1, 1, 0};
  const Vec3 given{2, 1, 0};
  const auto expect = [&](double time, const Vec3& place) {
    const Pose pose = path.pose(time);
    EXPECT_LT(norm(minus(pose.place(given), place)), 1e-14) << time;
    EXPECT_LT(norm(minus(pose.given(place), given)), 1e-14) << time;
  };
  expect(0, given);
  expect(1, given);
  expect(1.5, {1.5 + std::sqrt(0.5), 1 + std::sqrt(0.5), 0});
  expect(2, {2, 2, 0});
  expect(4, {3, 1, 2});
  expect(9, {3, 1, 2});
  EXPECT_NEAR(path.top_speed(0, 1), 1 + std::numbers::pi / 2, 1e-14);
  EXPECT_NEAR(path.top_speed(2, 1), 1 + std::numbers::pi / 4, 1e-14);
  EXPECT_EQ(path.top_speed(4, 1), 0);
  EXPECT_EQ(path.next_change(0), 1);
  EXPECT_EQ(path.next_change(2), 4);
  EXPECT_EQ(path.next_change(4), std::numeric_limits<double>::infinity());
}

TEST(RigidPath, IsSteeredFromWhereItIs) {
  RigidPath path;
  path.stations = {{0, {}, 0}, {2, {1, 0, 0}, 1}};
  path.axis = {1, 2, -1};
  path.centre = {1, 1, 0};
  const Pose before = path.pose(1);
  const Vec3 rotation{-1, 2, 0.5};
  const RigidPath steered = path.steered(1, {3, Vec3{0, 1, 0}, rotation});
  EXPECT_EQ(steered.pose(1).turn, before.turn);
  EXPECT_EQ(steered.pose(1).translation, before.translation);
  EXPECT_LT(norm(minus(rotation_vector(steered.pose(3)), rotation)), 1e-14);
  EXPECT_EQ(steered.pose(4).translation, (Vec3{0, 1, 0}));
  // A constant spin: half of it takes half the time.
  const Vec3 half = rotation_between(before.turn, steered.pose(2).turn);
  const Vec3 rest = rotation_between(steered.pose(2).turn, steered.pose(3).turn);
  EXPECT_GT(norm(half), 0.5);
  EXPECT_LT(norm(minus(half, rest)), 1e-14);
  EXPECT_EQ(steered.last_change(), 3);

  RigidPath turning;
  for (int i = 1; i <= 1000; ++i)  // to and fro between two orientations
    turning = turning.steered(i, {i + 0.7, Vec3{}, i % 2 ? rotation : Vec3{0, 0, 3}});
  const Pose last = turning.pose(1000.9);
  EXPECT_LT(norm(minus(rotation_vector(last), Vec3{0, 0, 3})), 1e-13);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(dot(last.turn[i], last.turn[j]), i == j, 1e-15);

  EXPECT_FALSE(path.steered(3, {4, {}, {}}).moves()) << "it stays";
}

}  // namespace
}  // namespace suture
