// SPDX-License-Identifier: GPL-3.0-or-later
//
// Solids bounded by triangles: distances against closed forms and against all triangles one by one.
#include "kernel/geometry/solid_surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "kernel/base/rows.hpp"
#include "kernel/contact/overlap.hpp"
#include "tests/dynamics/model_block.hpp"
#include "tests/geometry/surfaces.hpp"

namespace suture {
namespace {

using test::box_surface;
using test::sphere_surface;
using test::winding;

Shape solid(const TriangleSurface& surface) {
  const Box box = box_of(surface.points);
  return Triangulated{std::make_shared<SolidSurface>(surface),
                      scaled(0.5, plus(box.low, box.high))};
}

/// A ring around the z axis; its tube of radius 0.15 has its axis on a circle of radius 0.5.
TriangleSurface ring(Index around, Index across) {
  TriangleSurface surface;
  for (Index i = 0; i < around; ++i)
    for (Index j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
      const double r = 0.5 + 0.15 * std::cos(v);
      surface.points.push_back({r * std::cos(u), r * std::sin(u), 0.15 * std::sin(v)});
      const Index k = (i + 1) % around, l = (j + 1) % across;
      const Index a = i * across + j, b = k * across + j, c = k * across + l, d = i * across + l;
      surface.triangles.push_back({a, b, c});
      surface.triangles.push_back({a, c, d});
    }
  return surface;
}

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = minus(b, a);
  const double part = std::clamp(dot(minus(p, a), ab) / dot(ab, ab), 0.0, 1.0);
  return norm(minus(p, plus(a, scaled(part, ab))));
}

double distance_to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 area = cross(minus(b, a), minus(c, a)), n = scaled(1 / norm(area), area);
  const double height = dot(minus(p, a), n);
  const Vec3 q = minus(p, scaled(height, n));
  const auto is_left = [&](const Vec3& from, const Vec3& to) {
    return dot(cross(minus(to, from), minus(q, from)), n) >= 0;
  };
  if (is_left(a, b) && is_left(b, c) && is_left(c, a)) return std::abs(height);
  return std::min(
      {distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

double signed_distance(const TriangleSurface& s, const Vec3& p) {
  double distance = 1e300;
  for (const Triangle& t : s.triangles)
    distance =
        std::min(distance, distance_to_triangle(p, s.points[t[0]], s.points[t[1]], s.points[t[2]]));
  return winding(s, p) > 0.5 ? -distance : distance;
}

std::vector<Vec3> places(double reach, int count) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> coordinate(-reach, reach);
  std::vector<Vec3> all;
  for (int i = 0; i < count; ++i)
    all.push_back({coordinate(random), coordinate(random), coordinate(random)});
  return all;
}

TEST(SolidSurface, DistancesEqualThoseOfAllTrianglesOneByOne) {
  const TriangleSurface two = test::joined(box_surface({-0.9, -0.3, 0.3}, {-0.4, 0.4, 0.8}),
                                           sphere_surface({0.4, 0.1, 0.2}, 0.4, 2));
  for (const TriangleSurface& surface : {ring(16, 9), two}) {
    const Shape shape = solid(surface);
    int inside = 0;
    for (const Vec3& place : places(1, 1000)) {
      const double expected = signed_distance(surface, place);
      inside += expected < 0;
      ASSERT_NEAR(nearest(shape, place).distance, expected, 1e-14);
    }
    EXPECT_GT(inside, 15);
  }
}

TEST(SolidSurface, NoNearPlaceIsRuledOutAndMostFarOnesAre) {
  const Shape shape = solid(ring(40, 20));
  int far = 0, ruled_out = 0;
  for (const Vec3& place : places(1.5, 2000)) {
    const double distance = nearest(shape, place).distance;
    EXPECT_TRUE(may_be_within(shape, place, distance));
    far += distance > 0.1;
    ruled_out += !may_be_within(shape, place, 0.05);
  }
  EXPECT_GT(ruled_out, 0.95 * far);
}

TEST(SolidSurface, ABoxEqualsItsClosedFormToRounding) {
  const Box box{{-0.5, -0.4, -0.3}, {0.6, 0.2, 0.4}};
  const Shape closed = box, triangles = solid(box_surface(box.low, box.high));
  for (const Vec3& place : places(1, 2000)) {
    const Nearest expected = nearest(closed, place), found = nearest(triangles, place);
    ASSERT_NEAR(found.distance, expected.distance, 1e-14);
    if (expected.distance < 1e-3) continue;  // inside, several sides may be equally near
    EXPECT_LT(norm(minus(found.normal, expected.normal)), 1e-10);
  }
}

TEST(SolidSurface, SpheresConvergeToTheClosedForm) {
  const Vec3 centre{0.1, -0.2, 0.3};
  const Shape closed = Sphere{centre, 0.7};
  double before = 1;
  for (int rounds = 1; rounds <= 4; ++rounds) {
    const Shape triangles = solid(sphere_surface(centre, 0.7, rounds));
    double error = 0;
    for (const Vec3& place : places(1.2, 400))
      error = std::max(
          error, std::abs(nearest(triangles, place).distance - nearest(closed, place).distance));
    if (rounds > 1) {
      EXPECT_NEAR(before / error, 4, 0.7) << "second order";
    }
    before = error;
  }
  EXPECT_LT(before, 2e-3 * 0.7);
}

TEST(SolidSurface, OnTheSurfaceTheNormalIsThatOfTheFaceTheEdgeOrTheCorner) {
  const Shape box = solid(box_surface({0, 0, 0}, {1, 1, 1}));
  const auto expect = [&](const Vec3& place, const Vec3& along) {
    const Nearest found = nearest(box, place);
    EXPECT_NEAR(found.distance, 0, 1e-15);
    EXPECT_LT(norm(minus(found.normal, scaled(1 / norm(along), along))), 1e-14);
  };
  expect({0.3, 0.2, 1}, {0, 0, 1});
  expect({0.3, 1, 1}, {0, 1, 1});
  expect({1, 1, 1}, {1, 1, 1});
  expect({0.5, 0.5, 1}, {0, 0, 1});  // on the diagonal
}

TEST(SolidSurface, TheThicknessIsThatOfThePlateOrTheTube) {
  for (const double height :
       {0.5, 0.3, 0.07, 0.011}) {  // centroids of sides: height / 3 from an edge
    const double found = SolidSurface(box_surface({0, 0, 0}, {1, 1, height})).thickness();
    EXPECT_LE(found, height);
    EXPECT_GE(found, height / 3);
  }
  const double found = SolidSurface(ring(60, 30)).thickness();
  EXPECT_LE(found, 0.3);
  EXPECT_GE(found, 0.47 * 0.3);
}

TEST(SolidSurface, TrianglesWithoutAreaAreDropped) {
  TriangleSurface surface = box_surface({0, 0, 0}, {1, 1, 1});
  surface.triangles.push_back({0, 0, 1});
  EXPECT_NEAR(nearest(solid(surface), {0.5, 0.5, 2}).distance, 1, 1e-15);
  surface.triangles = {{0, 1, 1}};
  EXPECT_THROW(SolidSurface{surface}, InputError);
}

// ------------------------------------------------------------------------ contact --

struct Dropped : rig::Block {
  explicit Dropped(Obstacle obstacle)
      : Block("tm-faure", {{"E", 4e5}, {"nu", 0.3}, {"rho", 1000}}, {3, 3, 3}, 1. / 3,
              {rig::euler, 0, {1, 0.5, -10}, {}}),
        contact(body.add_contact({std::move(obstacle)}, 0.003)) {}
  Contact& contact;
};

Obstacle turning(Shape shape) {
  Obstacle obstacle{"o", "/contact/obstacles/0", std::move(shape), {}, 0.3};
  obstacle.motion.stations = {{0, {}, 0}, {1, {0, 0.05, 0.1}, 0.4}};
  obstacle.motion.centre = {0.3, 0.5, -0.2};
  return obstacle;
}

TEST(SolidSurface, AMovingBoxPushesAsItsClosedForm) {
  const Vec3 low{-0.3, -0.3, -0.4}, high{0.8, 1.3, -0.02};
  Dropped closed(turning(Box{low, high})), triangles(turning(solid(box_surface(low, high))));
  for (Dropped* block : {&closed, &triangles}) block->start();
  const double dt = 0.5 * closed.stable_step();
  double force = 0;
  for (int i = 0; i < 300; ++i) {
    for (Dropped* block : {&closed, &triangles}) block->run(dt, 1);
    const Contact::Load &one = closed.contact.loads()[0], &other = triangles.contact.loads()[0];
    force = std::max(force, norm(one.force));
    ASSERT_LT(norm(minus(one.force, other.force)), 1e-7 * (1 + force)) << "step " << i;
    ASSERT_LT(norm(minus(one.torque, other.torque)), 1e-7 * (1 + force)) << "step " << i;
  }
  EXPECT_GT(force, 1000);
}

TEST(SolidSurface, OverlapsAreFound) {
  const auto overlap = [](Shape shape) {
    Dropped block({"o", "", std::move(shape)});
    block.start();
    return find_overlaps(block.contact, block.body.complex(), block.body.attributes(), 0);
  };
  const auto partly = overlap(solid(box_surface({0.2, 0.2, -0.5}, {0.4, 0.4, 0.1})));
  ASSERT_EQ(partly.size(), 1u);
  EXPECT_EQ(partly[0].vertices, 1u);
  EXPECT_NEAR(partly[0].depth, 1. / 15 + 0.003, 1e-12) << "of the node at 1/3, with the thickness";
  const auto within = overlap(solid(sphere_surface({0.5, 0.5, 0.5}, 0.1, 1)));
  ASSERT_EQ(within.size(), 1u);
  EXPECT_EQ(within[0].vertices, 0u);
  EXPECT_TRUE(overlap(solid(sphere_surface({0.5, 0.5, 1.2}, 0.1, 1))).empty());
}

}  // namespace
}  // namespace suture
