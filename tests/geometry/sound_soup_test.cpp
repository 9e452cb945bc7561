// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is called sound is left as it is by CGAL, and no triangle that intersects another escapes.
#include "kernel/geometry/sound_soup.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <random>
#include <set>

#include "kernel/geometry/geometry_module.hpp"
#include "kernel/geometry/surface_tree.hpp"
#include "tests/geometry/surfaces.hpp"

namespace suture {
namespace {

using test::soup_of;

TriangleSurface sphere(int rounds = 2) { return test::sphere_surface({0, 0, 0}, 1, rounds); }

std::vector<Index> doubtful_of(const TriangleSurface& surface) {
  return find_doubtful(surface, SurfaceTree(surface));
}

bool is_sound_surface(const TriangleSurface& surface) { return is_sound(soup_of(surface)); }

TEST(SoundSoup, ClosedManifoldsAreSoundWhicheverSideIsOut) {
  EXPECT_TRUE(is_sound_surface(sphere()));
  EXPECT_TRUE(is_sound_surface(test::box_surface({0, 0, 0}, {1, 2, 3})));
  EXPECT_TRUE(is_sound_surface(test::joined(sphere(), test::box_surface({2, 2, 2}, {3, 3, 3}))));
  TriangleSurface inward = sphere();
  for (Triangle& t : inward.triangles) std::swap(t[1], t[2]);
  EXPECT_TRUE(is_sound_surface(inward));
}

TEST(SoundSoup, EveryOtherDefectIsSeen) {
  const auto broken = [](auto change) {
    TriangleSurface surface = sphere();
    change(surface);
    return !is_sound_surface(surface);
  };
  EXPECT_TRUE(broken([](TriangleSurface& s) { s.triangles.pop_back(); })) << "a hole";
  EXPECT_TRUE(broken([](TriangleSurface& s) { std::swap(s.triangles[5][0], s.triangles[5][1]); }))
      << "turned";
  EXPECT_TRUE(broken([](TriangleSurface& s) { s.triangles.push_back(s.triangles[3]); })) << "twice";
  EXPECT_TRUE(broken([](TriangleSurface& s) { s.points.push_back({5, 5, 5}); })) << "unused";
  EXPECT_TRUE(broken([](TriangleSurface& s) { s.points[3] = s.points[7]; })) << "equal points";
  EXPECT_TRUE(broken([](TriangleSurface& s) { s.triangles[4][2] = s.triangles[4][1]; }));
  EXPECT_TRUE(broken([](TriangleSurface& s) { s.triangles.clear(); })) << "empty";
  TriangleSurface touching = test::joined(sphere(), test::sphere_surface({9, 0, 0}, 1, 2));
  const auto half = static_cast<Index>(touching.points.size() / 2);
  for (Triangle& t : touching.triangles)
    for (Index& corner : t) corner = corner == half ? 0 : corner;
  touching.points[half] = touching.points.back();
  for (Triangle& t : touching.triangles)
    for (Index& corner : t) corner = corner == touching.points.size() - 1 ? half : corner;
  touching.points.pop_back();
  EXPECT_FALSE(is_sound_surface(touching)) << "two fans at a point";
  const TriangleSurface flat{"", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  EXPECT_FALSE(is_sound_surface(flat)) << "two sides of one triangle";
  PolygonSoup squares = soup_of(sphere());
  squares.offsets = {0, 4, 8};
  EXPECT_FALSE(is_sound(squares));
}

/// The triangles by their corners, from the smallest.
std::multiset<std::array<Vec3, 3>> corners_of(const TriangleSurface& surface) {
  std::multiset<std::array<Vec3, 3>> all;
  for (const Triangle& t : surface.triangles) {
    std::array<Vec3, 3> corners{surface.points[t[0]], surface.points[t[1]], surface.points[t[2]]};
    std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
    all.insert(corners);
  }
  return all;
}

TEST(SoundSoup, CgalChangesNothing) {
  for (const TriangleSurface& surface :
       {sphere(), test::joined(sphere(), test::sphere_surface({0, 0, 0}, 0.5, 1))}) {
    const PolygonSoup sound = soup_of(surface);
    PolygonSoup repaired = sound;  // the point without a triangle sends it through CGAL
    repaired.points.push_back({5, 5, 5});
    ASSERT_FALSE(is_sound(repaired));
    const Closing one = geometry_module().close(sound, false);
    const Closing other = geometry_module().close(repaired, false);
    EXPECT_EQ(corners_of(one.surface), corners_of(other.surface));
    EXPECT_EQ(one.components, other.components);
    EXPECT_EQ(one.crossings, other.crossings);
    EXPECT_DOUBLE_EQ(one.volume, other.volume);
  }
}

TEST(SoundSoup, NothingIsDoubtfulInSoundSurfaces) {
  EXPECT_TRUE(doubtful_of(sphere(4)).empty());
  const TriangleSurface box = test::box_surface({0, 0, 0}, {1, 2, 3});  // corners in other planes
  EXPECT_EQ(geometry_module().close(soup_of(box), false).crossings, 0u);
  // Rows of right angles in one plane: triangles of next columns touch the line between these.
  TriangleSurface sheet;
  const Index side = 8;
  for (Index i = 0; i < side * side; ++i)
    sheet.points.push_back({0.1 * (i / side), 0.3 * (i % side), 0});
  for (Index i = 0; i + side < side * side; ++i) {
    if (i % side + 1 == side) continue;
    sheet.triangles.push_back({i, i + side, i + side + 1});
    sheet.triangles.push_back({i, i + side + 1, i + 1});
  }
  EXPECT_TRUE(doubtful_of(sheet).empty());
}

TEST(SoundSoup, ASolidInOnePieceIsWhatCgalMakesOfIt) {
  TriangleSurface inward = sphere();
  for (Triangle& t : inward.triangles) std::swap(t[1], t[2]);
  for (const TriangleSurface& surface :
       {sphere(), inward, test::box_surface({1, 2, 3}, {1.001, 4, 6})}) {
    const std::optional<TriangleSurface> solid = sound_solid(soup_of(surface));
    const TriangleSurface closed = geometry_module().close(soup_of(surface), false).surface;
    ASSERT_TRUE(solid);
    EXPECT_EQ(solid->points, closed.points);
    EXPECT_EQ(solid->triangles, closed.triangles);
  }
}

TEST(SoundSoup, WhatMayHaveNoCertainInsideIsNoSolid) {
  const TriangleSurface hollow = test::joined(sphere(), test::sphere_surface({0, 0, 0}, 0.5, 1));
  EXPECT_FALSE(sound_solid(soup_of(hollow)));
  EXPECT_FALSE(sound_solid(soup_of(test::box_surface({1, 2, 3}, {1, 4, 6})))) << "flat";
  TriangleSurface open = sphere();
  open.triangles.pop_back();
  EXPECT_FALSE(sound_solid(soup_of(open)));
}

TEST(SoundSoup, EveryTriangleThatAnEdgeCrossesIsDoubtful) {
  const unsigned seed = 7;
  std::mt19937 random(seed);
  std::size_t crossings = 0;
  for (int round = 0; round < 20; ++round) {
    TriangleSurface surface = sphere();
    std::uniform_real_distribution<double> shift(-0.04 * round, 0.04 * round);
    for (Vec3& p : surface.points)
      for (double& x : p) x += shift(random);
    const std::vector<Index> doubtful = doubtful_of(surface);
    const auto is_doubtful = [&](std::size_t i) {
      return std::ranges::binary_search(doubtful, static_cast<Index>(i));
    };
    for (std::size_t i = 0; i < surface.triangles.size(); ++i)
      for (std::size_t j = 0; j < surface.triangles.size(); ++j) {
        const Triangle &t = surface.triangles[i], &other = surface.triangles[j];
        for (std::size_t k = 0; k < 3; ++k) {
          const Index from = other[k], to = other[(k + 1) % 3];
          if (std::ranges::count(t, from) + std::ranges::count(t, to) != 0) continue;
          if (!geometry_module().crosses(
                  {surface.points[t[0]], surface.points[t[1]], surface.points[t[2]]},
                  {surface.points[from], surface.points[to]}))
            continue;
          ++crossings;
          ASSERT_TRUE(is_doubtful(i) && is_doubtful(j)) << "seed " << seed << " round " << round;
        }
      }
  }
  EXPECT_GT(crossings, 1000u);
}

TEST(SoundSoup, FoldsAndDoubledSheetsAreDoubtful) {
  // A neighbour folded flat onto the other; with a third point beside, it is only unfolded.
  TriangleSurface fold{
      "", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.1, 0.5, 0}}, {{0, 1, 2}, {1, 0, 3}}};
  EXPECT_EQ(doubtful_of(fold).size(), 2u);
  fold.points[3] = {0.1, -0.5, 0};
  EXPECT_TRUE(doubtful_of(fold).empty());
  // Two triangles in a plane that share a corner and overlap, or do not.
  TriangleSurface corner{
      "", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0.5, 0}, {0.5, 1, 0}}, {{0, 1, 2}, {0, 3, 4}}};
  EXPECT_EQ(doubtful_of(corner).size(), 2u);
  corner.points[3] = {-1, 0.5, 0};
  corner.points[4] = {-1, -0.5, 0};
  EXPECT_TRUE(doubtful_of(corner).empty());
  EXPECT_EQ(doubtful_of(test::joined(sphere(), sphere())).size(), 2 * sphere().triangles.size());
}

}  // namespace
}  // namespace suture
