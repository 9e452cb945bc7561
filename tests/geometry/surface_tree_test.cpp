// SPDX-License-Identifier: GPL-3.0-or-later
//
// The hierarchy over triangles, against all triangles one by one.
#include "kernel/geometry/surface_tree.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "kernel/base/vec3.hpp"
#include "tests/geometry/surfaces.hpp"

namespace suture {
namespace {

double distance(const TriangleSurface& s, Index i, const Vec3& p) {
  const Triangle& t = s.triangles[i];
  const Weights w = nearest_in(s.points[t[0]], s.points[t[1]], s.points[t[2]], p);
  return norm(minus(p, plus(scaled(w.a, s.points[t[0]]),
                            plus(scaled(w.b, s.points[t[1]]), scaled(w.c, s.points[t[2]])))));
}

/// Triangles of any size and direction in a cube.
TriangleSurface scattered(Index count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-1, 1), size(-0.2, 0.2);
  TriangleSurface surface;
  for (Index i = 0; i < count; ++i) {
    const Vec3 middle{place(random), place(random), place(random)};
    for (int corner = 0; corner < 3; ++corner)
      surface.points.push_back(plus(middle, {size(random), size(random), size(random)}));
    surface.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return surface;
}

std::vector<TriangleSurface> surfaces() {
  return {scattered(1, 1), scattered(2, 2), scattered(7, 3), scattered(500, 4),
          test::sphere_surface({0.1, 0, 0.2}, 0.5, 3)};
}

TEST(SurfaceTree, TheNearestIsThatOfAllOneByOne) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-1.5, 1.5);
  for (const TriangleSurface& surface : surfaces()) {
    const SurfaceTree tree(surface);
    const auto count = static_cast<Index>(surface.triangles.size());
    for (int i = 0; i < 200; ++i) {
      const Vec3 p{place(random), place(random), place(random)};
      double least = 1e300;
      for (Index t = 0; t < count; ++t) least = std::min(least, distance(surface, t, p));
      EXPECT_NEAR(distance(surface, tree.nearest(p, i % count), p), least, 1e-15) << i;
      EXPECT_TRUE(tree.is_within(p, least * (1 + 1e-12)));
      EXPECT_FALSE(tree.is_within(p, least * (1 - 1e-12)));
      EXPECT_NE(tree.nearest(p, 0, least * (1 + 1e-12)), none);
      EXPECT_EQ(tree.nearest(p, 0, least * (1 - 1e-12)), none);
    }
  }
}

/// Beyond a corner or the middle of a side, several triangles are as near.
TEST(SurfaceTree, TheFirstOfThoseAsNearIsFoundFromEverywhere) {
  const TriangleSurface surface = test::sphere_surface({0, 0, 0}, 0.5, 2);
  const SurfaceTree tree(surface);
  const auto count = static_cast<Index>(surface.triangles.size());
  std::vector<Vec3> places;
  for (const Triangle& t : surface.triangles) {
    const Vec3 &a = surface.points[t[0]], &b = surface.points[t[1]];
    places.insert(places.end(), {scaled(2, a), plus(a, b)});
  }
  int ties = 0;
  for (const Vec3& place : places) {
    const Index found = tree.nearest(place, 0);
    for (Index start = 1; start < count; ++start) {
      ASSERT_EQ(tree.nearest(place, start), found);
      ties += start != found && distance(surface, start, place) == distance(surface, found, place);
    }
  }
  EXPECT_GT(ties, 0);
}

TEST(SurfaceTree, EveryTriangleIsInItsOrderOnce) {
  for (const TriangleSurface& surface : surfaces()) {
    const SurfaceTree tree(surface);
    const std::set<Index> all(tree.order().begin(), tree.order().end());
    EXPECT_EQ(all.size(), surface.triangles.size());
    EXPECT_EQ(tree.order().size(), surface.triangles.size());
  }
}

TEST(SurfaceTree, EachPairOfOverlappingBoxesIsVisitedOnce) {
  for (const TriangleSurface& surface : surfaces()) {
    std::set<std::array<Index, 2>> visited;
    SurfaceTree(surface).for_overlaps([&](auto some, auto others) {
      for (std::size_t i = 0; i < some.size(); ++i)
        for (std::size_t j = some.data() == others.data() ? i + 1 : 0; j < others.size(); ++j)
          EXPECT_TRUE(
              visited.insert({std::min(some[i], others[j]), std::max(some[i], others[j])}).second);
    });
    std::vector<Box> boxes;
    for (const Triangle& t : surface.triangles)
      boxes.push_back(box_of({surface.points[t[0]], surface.points[t[1]], surface.points[t[2]]}));
    for (Index i = 0; i < boxes.size(); ++i)
      for (Index j = i + 1; j < boxes.size(); ++j) {
        bool overlap = true;
        for (std::size_t c = 0; c < 3; ++c)
          overlap &= boxes[i].low[c] <= boxes[j].high[c] && boxes[j].low[c] <= boxes[i].high[c];
        if (overlap) {
          EXPECT_TRUE(visited.contains({i, j})) << i << ' ' << j;
        }
      }
  }
}

}  // namespace
}  // namespace suture
