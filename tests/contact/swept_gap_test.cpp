// SPDX-License-Identifier: GPL-3.0-or-later
//
// Gaps of places that came along a way, compared with a walk along it in small steps.
#include "kernel/contact/swept_gap.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <random>

#include "kernel/base/rows.hpp"
#include "kernel/geometry/solid_surface.hpp"
#include "tests/geometry/surfaces.hpp"

namespace suture {
namespace {

/// Thin, in boxes of about 1 m.
const std::vector<Shape>& thin_shapes() {
  static const std::vector<Shape> all{
      Sphere{{0.1, -0.1, 0.1}, 0.1}, Capsule{{-0.4, 0, 0.1}, {0.5, 0.3, -0.2}, 0.02},
      Box{{-0.5, -0.4, 0.1}, {0.6, 0.2, 0.101}}, Cylinder{{-0.1, 0, 0}, {-0.1, 0.005, 0.01}, 0.4},
      Triangulated{
          std::make_shared<SolidSurface>(test::box_surface({-0.5, -0.4, -0.3}, {0.6, 0.2, -0.29})),
          {0.1, 0, 0.2}}};
  return all;
}

Vec3 random_place(std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  return {coordinate(random), coordinate(random), coordinate(random)};
}

/// The normals where a way goes in first and comes out last, by small steps.
struct Walk {
  std::optional<Vec3> in, out;
  double clearance = 2;    ///< the smallest distance on the way
  bool is_at_rim = false;  ///< where the normals in front of the surface and behind it differ
};

constexpr int steps = 8000;  // of a walk

Walk walk(const Shape& shape, double offset, const Vec3& from, const Vec3& to) {
  Walk walk;
  Nearest before = nearest(shape, from);
  for (int i = 0; i <= steps; ++i) {
    const Vec3 place = plus(from, scaled(double(i) / steps, minus(to, from)));
    const Nearest here = nearest(shape, place);
    const bool was_inside = before.distance < offset, is_inside = here.distance < offset;
    if (is_inside && !walk.in) walk.in = before.normal;
    if (was_inside && !is_inside) walk.out = here.normal;
    if (was_inside != is_inside) walk.is_at_rim |= dot(here.normal, before.normal) < 0.9;
    walk.clearance = std::min(walk.clearance, here.distance - offset);
    before = here;
  }
  return walk;
}

class ThinShapes : public testing::TestWithParam<std::size_t> {
 protected:
  const Shape& shape() const { return thin_shapes()[GetParam()]; }
};
INSTANTIATE_TEST_SUITE_P(SweptGap, ThinShapes, testing::Range(std::size_t{0}, thin_shapes().size()),
                         [](const auto& test) { return name_of(thin_shapes()[test.param]); });

/// Between two places outside: a way that comes out where it went in leaves the place alone, and
/// one that comes out on the other side is inside by its depth under the plane where it went in.
TEST_P(ThinShapes, BelongToTheSideWhereTheWayWentIn) {
  std::mt19937 random(7);
  int passed = 0, missed = 0;
  const std::vector<Vec3> inside = points_inside(shape());
  for (int i = 0; i < 100; ++i) {
    const Vec3 from = random_place(random);
    const Vec3 middle = inside[random() % inside.size()];
    const Vec3 aim = plus(middle, scaled(i % 4 < 2 ? 0.05 : 0.3, random_place(random)));
    const Vec3 to = plus(from, scaled(1.5 + (random() % 100) / 50., minus(aim, from)));
    const double offset = i % 2 == 0 ? 0 : 0.01;
    const Nearest end = nearest(shape(), to);
    if (nearest(shape(), from).distance <= offset || end.distance <= offset) continue;
    const Walk walked = walk(shape(), offset, from, to);
    const Nearest swept = swept_gap(shape(), offset, from, to);
    const double turned = walked.in && walked.out ? dot(*walked.in, *walked.out) : 1;
    const bool may_step_over = !walked.in && walked.clearance < norm(minus(to, from)) / steps;
    if (walked.is_at_rim || std::abs(turned) < 0.1 || may_step_over) continue;
    SCOPED_TRACE(i);
    if (turned > 0) {
      EXPECT_EQ(swept.distance, end.distance - offset);
      EXPECT_EQ(swept.normal, end.normal);
      ++missed;
    } else {
      EXPECT_LT(swept.distance, 0);
      EXPECT_GT(dot(swept.normal, *walked.in), 0.9);
      EXPECT_LT(dot(swept.normal, minus(to, from)), 0);
      const Vec3 lifted = minus(to, scaled(swept.distance, swept.normal));
      EXPECT_GT(nearest(shape(), lifted).distance, offset - 1e-6);
      ++passed;
    }
  }
  EXPECT_GT(passed, 10);
  EXPECT_GT(missed, 10);
}

/// From the surface, and from just inside it, at any slope.
TEST(SweptGap, HoldsAVertexThatTouchesOnItsSide) {
  const Shape plate = Box{{-1, -1, 0}, {1, 1, 1e-4}};
  for (const double start : {1e-4, 1e-4 - 1e-6, 1e-4 + 1e-12, 0.3})
    for (const double slope : {1e-6, 1e-3, 1., 1e3}) {
      const Vec3 from{-0.5, 0, start},
          to{-0.5 + 0.01 / (1 + slope), 0, -0.01 * slope / (1 + slope)};
      const Nearest gap = swept_gap(plate, 0, from, to);
      EXPECT_NEAR(gap.distance, to[2] - 1e-4, 1e-14) << start << ' ' << slope;
      EXPECT_EQ(gap.normal, (Vec3{0, 0, 1}));
    }
  EXPECT_NEAR(swept_gap(plate, 0, {0, 0, -1e-9}, {0, 0, 0.2}).distance, -0.2, 1e-14)
      << "from below";
}

/// What slides off a rod, or past the rim of a plate, is not held.
TEST(SweptGap, LetsGoWhatSlidesOff) {
  const Shape rod = Capsule{{0, -1, 0}, {0, 1, 0}, 1e-3};
  const Nearest beside = swept_gap(rod, 0, {0, 0, 1e-3}, {0.01, 0, 0.9e-3});
  EXPECT_GT(beside.distance, 0.008);
  const Shape plate = Box{{-1, -1, 0}, {1, 1, 1e-4}};
  EXPECT_GT(swept_gap(plate, 0, {1.001, 0, 0.01}, {1.001, 0, -0.01}).distance, 0.001);
}

/// A thin bowl: the way to the other side of its own wall is through it, that along its inside is
/// not.
TEST(SweptGap, KnowsBothSidesOfAThinShell) {
  TriangleSurface shell = test::box_surface({-1, -1, -1}, {1, 1, 1});
  TriangleSurface inner = test::box_surface({-0.99, -0.99, -0.99}, {0.99, 0.99, 0.99});
  const auto first = static_cast<Index>(shell.points.size());
  shell.points.insert(shell.points.end(), inner.points.begin(), inner.points.end());
  for (const Triangle& t : inner.triangles)
    shell.triangles.push_back({t[0] + first, t[2] + first, t[1] + first});
  const Shape hollow = Triangulated{std::make_shared<SolidSurface>(shell), {}};
  EXPECT_GE(thickness(hollow), 0.005);
  EXPECT_LE(thickness(hollow), 0.01 * (1 + 1e-6));
  const Nearest through = swept_gap(hollow, 0, {0.1, 0.2, 0}, {0.1, 0.2, 1.5});
  EXPECT_NEAR(through.distance, -0.51, 1e-3);
  EXPECT_NEAR(through.normal[2], -1, 1e-12);
  EXPECT_NEAR(swept_gap(hollow, 0, {0.1, 0.2, 0}, {0.3, -0.2, 0.5}).distance, 0.49, 1e-3);
  EXPECT_NEAR(swept_gap(hollow, 0, {0.1, 0.2, 1.6}, {0.1, 0.2, 1.1}).distance, 0.1, 1e-3);
}

TEST(Thickness, IsThatOfTheThinnestPart) {
  for (const Shape& shape : thin_shapes()) {
    const double expected[] = {0.2, 0.04, 1e-3, std::hypot(0.005, 0.01), 0.01};
    const double most = expected[&shape - thin_shapes().data()], found = thickness(shape);
    EXPECT_LE(found, most * (1 + 1e-6)) << name_of(shape);
    EXPECT_GE(found, most * (std::holds_alternative<Triangulated>(shape) ? 0.33 : 1 - 1e-12))
        << name_of(shape);
  }
  EXPECT_DOUBLE_EQ(width(Capsule{{0, 0, 0}, {1, 1, 0}, 0.1}), 0.2);
  EXPECT_DOUBLE_EQ(width(Box{{0, 0, 0}, {3, 0.5, 2}}), 2);
  EXPECT_DOUBLE_EQ(width(Cylinder{{0, 0, 0}, {0, 0, 0.1}, 1}), 2);
  EXPECT_NEAR(width(thin_shapes()[4]), 0.6, 1e-9);
}

}  // namespace
}  // namespace suture
