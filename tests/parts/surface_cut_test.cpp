// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cuts along triangles that divide elements: curved, closed, and ending inside the body.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>

#include "kernel/base/error.hpp"
#include "tests/geometry/surfaces.hpp"
#include "tests/parts/cut_box.hpp"

namespace suture::test::surface_cut_test {
namespace {

using std::numbers::pi;
using testing::HasSubstr;

/// A parallelogram of two triangles.
TriangleSurface sheet(const Vec3& corner, const Vec3& one, const Vec3& other) {
  return {"sheet",
          {corner, plus(corner, one), plus(plus(corner, one), other), plus(corner, other)},
          {{0, 1, 2}, {0, 2, 3}}};
}

/// A tube along z, open at both ends.
TriangleSurface tube(double x, double y, double radius, double length, Index sides) {
  TriangleSurface tube{"tube", {}, {}};
  for (Index i = 0; i < sides; ++i) {
    const double angle = 2 * pi * i / sides;
    for (const double z : {-1.0, length + 1})
      tube.points.push_back({x + radius * std::cos(angle), y + radius * std::sin(angle), z});
    const Index a = 2 * i, b = 2 * ((i + 1) % sides);
    tube.triangles.push_back({a, b, b + 1});
    tube.triangles.push_back({a, b + 1, a + 1});
  }
  return tube;
}

void expect_sound(CutBox& box, double volume) {
  ASSERT_NO_FATAL_FAILURE(expect_valid(box));
  ASSERT_NEAR(box.volume(), volume, volume * 1e-12);
}

/// The volumes of the pieces, ascending.
std::vector<double> volumes(const CutBox& box) {
  std::map<Index, double> sums;
  for (Index e = 0; e < box.complex.element_count(); ++e)
    if (box.complex.exists(3, e))
      sums[box.islands.of(e)] += box.part(e) ? box.part(e)->fraction : 1;
  std::vector<double> result;
  for (const auto& [island, sum] : sums) result.push_back(sum);
  std::ranges::sort(result);
  return result;
}

TEST(surface_cut, flat_triangles_cut_as_their_plane) {
  const Vec3 one{9, 1, 2}, other{-1, 9, 3}, middle{2.1, 1.9, 2.2};
  const Vec3 corner = minus(middle, scaled(0.5, plus(one, other)));
  CutBox by_plane({4, 4, 4}), by_sheet({4, 4, 4});
  const BladeCut plane = by_plane.cut({.point = middle, .normal = cross(one, other)});
  TriangleSurface apart = sheet(corner, one, other);  // no point is shared
  for (const Index p : {0u, 2u}) apart.points.push_back(Vec3(apart.points[p]));
  apart.triangles[1] = {4, 5, 3};
  const BladeCut cut = by_sheet.cut(SurfacePatch(apart));
  EXPECT_EQ(cut.divided, plane.divided);
  EXPECT_GT(cut.divided, 15u);
  const std::vector<double> a = volumes(by_plane), b = volumes(by_sheet);
  ASSERT_EQ(a.size(), 2u);
  ASSERT_EQ(b.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(a[i], b[i], 1e-11);
  EXPECT_NEAR(lip_area(by_sheet, by_sheet.parts.embedding(by_sheet.complex)),
              lip_area(by_plane, by_plane.parts.embedding(by_plane.complex)), 1e-10);
}

// Elements see the distance at their nodes, and interpolate: its curvature is missed, of order 2.
TEST(surface_cut, a_ball_comes_out_with_its_volume_and_area) {
  std::vector<double> volume_errors, area_errors;
  for (const Index n : {6, 12, 24}) {
    CutBox box({n, n, n});
    const double radius = 0.31 * n;
    const Vec3 centre{0.49 * n, 0.52 * n, 0.5 * n};
    box.cut(SurfacePatch(sphere_surface(centre, radius, 5)));
    expect_sound(box, n * n * n);
    const Embedding& embedding = box.parts.embedding(box.complex);
    ASSERT_NO_FATAL_FAILURE(expect_closed(embedding));
    const std::vector<double> pieces = volumes(box);
    ASSERT_EQ(pieces.size(), 2u);
    volume_errors.push_back(pieces[0] / (4. / 3 * pi * std::pow(radius, 3)) - 1);
    area_errors.push_back(lip_area(box, embedding) / (8 * pi * radius * radius) - 1);
  }
  for (const auto& errors : {volume_errors, area_errors}) {
    EXPECT_LT(std::abs(errors[1]), 0.05);
    EXPECT_LT(std::abs(errors[2]), 0.012);
    EXPECT_GT(std::log2(errors[0] / errors[1]), 1.6);
  }
}

TEST(surface_cut, a_tube_punches_out_a_cylinder) {
  CutBox box({12, 12, 6});
  box.cut(SurfacePatch(tube(6.1, 5.9, 3.3, 6, 200)));
  expect_sound(box, 12 * 12 * 6);
  ASSERT_NO_FATAL_FAILURE(expect_closed(box.parts.embedding(box.complex)));
  const std::vector<double> pieces = volumes(box);
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_NEAR(pieces[0], 6 * pi * 3.3 * 3.3, 0.02 * 6 * pi * 3.3 * 3.3);
}

TEST(surface_cut, elements_beyond_the_rim_stay_whole) {
  CutBox box({6, 6, 6});
  const BladeCut cut = box.cut(SurfacePatch(sheet({-1, -1, 2.4}, {4.5, 0, 0}, {0, 8, 0})));
  EXPECT_EQ(cut.divided, 3u * 6u) << "the fourth row is crossed in part";
  expect_sound(box, 216);
  EXPECT_EQ(box.islands.existing(), 1u);
}

TEST(surface_cut, a_plane_of_the_grid_separates_faces) {
  CutBox box({4, 4, 4});
  const BladeCut cut = box.cut(SurfacePatch(sheet({2, -1, -1}, {0, 6, 0}, {0, 0, 6})));
  EXPECT_EQ(cut.divided, 0u);
  EXPECT_EQ(cut.cloning.cut.size(), 16u);
  EXPECT_EQ(box.islands.existing(), 2u);
}

TEST(surface_cut, nothing_far_away_or_smaller_than_an_element_is_cut) {
  CutBox box({4, 4, 4});
  EXPECT_TRUE(box.cut(SurfacePatch(sheet({9, 9, 9}, {1, 0, 0}, {0, 1, 0}))).empty());
  EXPECT_TRUE(box.cut(SurfacePatch(sphere_surface({1.5, 1.5, 1.5}, 0.2, 2))).empty());
}

// Balls that cross each other, tubes and planes, one after the other.
TEST(surface_cut, random_sequences_keep_volume_surface_and_map) {
  for (unsigned seed = 1; seed <= (std::getenv("SUTURE_FULL") ? 1000u : 25u); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> place(0, 5), size(1, 3);
    CutBox box({5, 5, 5});
    for (unsigned i = 0; i < 1 + seed % 4; ++i) {
      const Vec3 p{place(random), place(random), place(random)};
      const double r = size(random);
      if (random() % 3 != 0)
        box.cut(
            SurfacePatch(random() % 2 != 0 ? sphere_surface(p, r, 3) : tube(p[0], p[1], r, 5, 40)));
      else
        box.cut({.point = p, .normal = {r, p[0] - 2, p[1] - 2}});
      ASSERT_NO_FATAL_FAILURE(expect_sound(box, 125));
      const Embedding& embedding = box.parts.embedding(box.complex);
      ASSERT_NO_FATAL_FAILURE(expect_closed(embedding));
      ASSERT_NEAR(surface_volume(box, embedding), 125, 125e-12);
    }
  }
}

TEST(surface_cut, a_blade_without_two_sides_is_refused) {
  TriangleSurface turned = sheet({0, 0, 2.4}, {4, 0, 0}, {0, 4, 0});
  std::swap(turned.triangles[1][0], turned.triangles[1][1]);
  EXPECT_THAT(error_of<InputError>([&] { SurfacePatch patch(turned); }),
              HasSubstr("sheet: triangles with different sides up share the edge from (4, 4, 2.4) "
                        "to (0, 0, 2.4) m, so the blade has no two sides"));
  TriangleSurface fin = sheet({0, 0, 2.4}, {4, 0, 0}, {0, 4, 0});
  fin.points.push_back({2, 2, 5});
  fin.triangles.push_back({2, 0, 4});
  EXPECT_THAT(error_of<InputError>([&] { SurfacePatch patch(fin); }),
              HasSubstr("three triangles share the edge"));
}

}  // namespace
}  // namespace suture::test::surface_cut_test
