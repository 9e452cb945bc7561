// SPDX-License-Identifier: GPL-3.0-or-later
//
// What contact between pieces is found with: the nearest point of a patch, near pairs and edges
// against a search of all pairs, sweeps, and missed approaches.
#include <gtest/gtest.h>

#include <random>

#include "kernel/base/rows.hpp"
#include "kernel/contact/missed_approach.hpp"
#include "kernel/contact/near_edges.hpp"
#include "kernel/contact/patch.hpp"
#include "kernel/contact/touch_sweeps.hpp"
#include "tests/dynamics/model_block.hpp"
#include "tests/topology/operations.hpp"

namespace suture {
namespace {

// ------------------------------------------------------------- missed approaches --

TEST(MissedApproach, IsFoundAtTheDistanceAtWhichItMayHappen) {
  const Mesh mesh = make_box({.size = {20, 20, 1}, .cells = {20, 20, 1}});
  const CellComplex complex(mesh.hexahedra, static_cast<Index>(mesh.points.size()));
  const BoundarySurface surface(complex);
  std::vector<double> from(4 * mesh.points.size());
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    for (std::size_t c = 0; c < 3; ++c) from[4 * v + c] = mesh.points[v][c];
  const auto missed = [&](const Vec3& all, double bend) {
    std::vector<double> to = from;
    for (std::size_t i = 0; i < to.size(); ++i)
      if (i % 4 < 3) to[i] += all[i % 4] + (i % 4 == 2 ? bend * from[i - 2] : 0);
    return find_missed_approach(surface.vertices(), from.data(), to.data(), 1, 0.3);
  };
  EXPECT_FALSE(missed({7, 8, 9}, 0)) << "everything moves by the same way";
  EXPECT_FALSE(missed({}, 0.1)) << "2 edges over 20 edges";
  const auto found = missed({7, 8, 9}, 0.2);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->distance, 4);
  EXPECT_EQ(found->allowed, 1.3);
  EXPECT_GT(found->way, 1.3);
  for (std::size_t v = 0; v < mesh.points.size(); ++v)  // one end jumps onto the other
    if (mesh.points[v][0] > 18) from[4 * v] += 100;
  const auto jump = [&] {
    std::vector<double> to = from;
    for (std::size_t v = 0; v < mesh.points.size(); ++v)
      if (mesh.points[v][0] > 18) to[4 * v] -= 90;
    return find_missed_approach(surface.vertices(), from.data(), to.data(), 1, 0.3);
  }();
  ASSERT_TRUE(jump);
  EXPECT_EQ(jump->distance, 64) << "the first size whose cubes touch across the gap";
}

// --------------------------------------------------------------------- patches --

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

// ----------------------------------------------------------------------- sweeps --

/// A vertex of 1 kg that approaches a held face at 1 m/s.
TEST(TouchSweeps, ImproveWhatOthersHaveMoved) {
  std::vector<double> velocities(4 * 5);
  velocities[2] = -1;
  PieceTouch touch{};
  touch.vertices = {0, 1, 2, 3, 4};
  touch.weights = {1, -0.25, -0.25, -0.25, -0.25};
  touch.response = {1, 0, 0, 0, 0};
  touch.normal = {0, 0, 1};
  touch.mass = 1;
  const double dt = 0.1;
  TouchSweeps sweeps;
  sweeps.begin({&touch, 1});
  const auto sweep = [&] { return sweeps.sweep({&touch, 1}, velocities.data(), 0, dt, 0.01); };
  EXPECT_EQ(sweep(), dt);
  EXPECT_EQ(velocities[2], 0);
  velocities[2] = -0.5;
  sweeps.disturb(0, 0.006);
  EXPECT_EQ(sweep(), 0) << "less than is worth a look";
  sweeps.disturb(0, 0.006);
  EXPECT_EQ(sweep(), 0.5 * dt) << "both add up";
  EXPECT_EQ(velocities[2], 0);
  EXPECT_EQ(touch.impulse, 1.5);
}

// ------------------------------------------------------------------- near pairs --

/// A block that falls apart at random faces, with its points scattered.
struct Soup {
  CellComplex complex;
  std::vector<double> positions;
  std::vector<Index> piece_of;

  explicit Soup(unsigned seed) {
    std::mt19937 random(seed);
    Mesh mesh = make_box({.size = {5, 5, 5}, .cells = {5, 5, 5}});
    complex = CellComplex(mesh.hexahedra, static_cast<Index>(mesh.points.size()));
    std::vector<Dart> faces;
    for (Dart d = 0; d < 24 * complex.element_count(); d += 4)
      if (complex.can_cut(d) && random() % 4 != 0) faces.push_back(d);
    complex.cut(faces);
    std::uniform_real_distribution<double> scatter(-0.4, 0.4);
    positions.resize(4 * std::size_t{complex.count(0)});
    piece_of.resize(complex.count(0), none);
    const std::vector<Index> islands = complex.islands();
    for (Index e = 0; e < complex.element_count(); ++e)
      for (std::size_t i = 0; i < 8; ++i) {
        const Index v = complex.vertices_of(e)[i];
        piece_of[v] = islands[e];
        for (std::size_t c = 0; c < 3; ++c)
          positions[4 * std::size_t{v} + c] = mesh.points[mesh.hexahedra[e][i]][c];
      }
    for (double& c : positions) c += scatter(random);
  }
};

/// Some vertices and faces may touch their own piece.
Meeting meeting_of(const Soup& soup, const BoundarySurface& surface, unsigned seed) {
  std::mt19937 random(seed);
  Meeting meeting{soup.piece_of};
  if (seed % 2 == 0) return meeting;
  for (std::size_t v = 0; v < soup.piece_of.size(); ++v)
    meeting.vertex_meets_own.push_back(random() % 2 == 0);
  for (std::size_t face = 0; face < surface.corners().size(); ++face)
    meeting.face_meets_own.push_back(random() % 2 == 0);
  return meeting;
}

bool may_meet(const Meeting& meeting, const BoundarySurface& surface, Index v, Index face) {
  const auto& corners = surface.corners()[face];
  if (meeting.piece_of[v] != meeting.piece_of[corners[0]]) return true;
  return !meeting.face_meets_own.empty() && meeting.face_meets_own[face] &&
         meeting.vertex_meets_own[v] && std::ranges::find(corners, v) == corners.end();
}

std::vector<NearPair> pairs_by_search_of_all(const Soup& soup, const BoundarySurface& surface,
                                             const Meeting& meeting, double reach) {
  std::vector<NearPair> pairs;
  for (Index face = 0; face < surface.corners().size(); ++face)
    for (const Index v : surface.vertices()) {
      const auto& corners = surface.corners()[face];
      if (!may_meet(meeting, surface, v, face)) continue;
      bool inside = true;
      for (std::size_t c = 0; c < 3; ++c) {
        double low = 1e30, high = -1e30;
        for (const Index corner : corners) {
          low = std::min(low, row(soup.positions.data(), corner)[c]);
          high = std::max(high, row(soup.positions.data(), corner)[c]);
        }
        const double x = row(soup.positions.data(), v)[c];
        inside &= x >= low - reach && x <= high + reach;
      }
      if (inside) pairs.push_back({v, face});
    }
  std::ranges::sort(pairs);
  return pairs;
}

TEST(NearPairs, EqualThoseOfASearchOfAllPairs) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Soup soup(seed);
    const BoundarySurface surface(soup.complex);
    const double reach = 0.05 * seed;
    const Meeting meeting = meeting_of(soup, surface, seed);
    const auto expected = pairs_by_search_of_all(soup, surface, meeting, reach);
    EXPECT_GT(expected.size(), 1000u);
    EXPECT_EQ(near_pairs(surface, meeting, soup.positions.data(), reach), expected)
        << "seed " << seed;
  }
}

TEST(NearPairs, AreFoundForFacesOfAnySize) {
  Soup soup(1);
  const BoundarySurface surface(soup.complex);
  for (std::size_t i = 0; i < 4; ++i) {  // one face is far larger than the others
    soup.positions[4 * std::size_t{surface.corners()[0][i]}] *= 1e6;
    soup.positions[4 * std::size_t{surface.corners()[0][i]} + 2] *= -1e9;
  }
  const Meeting meeting{soup.piece_of};
  EXPECT_EQ(near_pairs(surface, meeting, soup.positions.data(), 0.1),
            pairs_by_search_of_all(soup, surface, meeting, 0.1));
}

// ------------------------------------------------------------------------- edges --

std::vector<NearEdges> edges_by_search_of_all(const Soup& soup,
                                              const std::vector<FeatureEdge>& edges, bool self,
                                              double reach) {
  const auto are_near = [&](const FeatureEdge& a, const FeatureEdge& b) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto at = [&](Index v) { return row(soup.positions.data(), v)[c]; };
      const auto [low, high] = std::minmax({at(a.ends[0]), at(a.ends[1])});
      const auto [other_low, other_high] = std::minmax({at(b.ends[0]), at(b.ends[1])});
      if (low - reach > other_high || other_low > high + reach) return false;
    }
    return true;
  };
  std::vector<NearEdges> pairs;
  for (Index i = 0; i < edges.size(); ++i)
    for (Index j = i + 1; j < edges.size(); ++j) {
      const FeatureEdge &a = edges[i], &b = edges[j];
      const bool share = a.ends[0] == b.ends[0] || a.ends[0] == b.ends[1] ||
                         a.ends[1] == b.ends[0] || a.ends[1] == b.ends[1];
      const bool is_own = soup.piece_of[a.ends[0]] == soup.piece_of[b.ends[0]];
      if ((!is_own || (self && !share)) && are_near(a, b)) pairs.push_back({i, j});
    }
  return pairs;
}

TEST(NearEdges, EqualThoseOfASearchOfAllPairs) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Soup soup(seed);
    const BoundarySurface surface(soup.complex);
    const auto edges = feature_edges(soup.complex, surface, soup.positions.data());
    const double reach = 0.05 * seed;
    const auto expected = edges_by_search_of_all(soup, edges, seed % 2 == 0, reach);
    EXPECT_GT(expected.size(), 1000u);
    EXPECT_EQ(near_edges(edges, soup.piece_of, seed % 2 == 0, soup.positions.data(), reach),
              expected)
        << "seed " << seed;
  }
}

TEST(FeatureEdges, AreWhereTheSurfaceBendsOutward) {
  const Mesh mesh = make_box({.size = {2, 2, 1}, .cells = {2, 2, 1}});
  CellComplex complex(mesh.hexahedra, static_cast<Index>(mesh.points.size()));
  complex.pierce(std::vector<Index>{3});  // an L, with one inner corner
  std::vector<double> positions(4 * mesh.points.size());
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    std::ranges::copy(mesh.points[v], positions.begin() + 4 * static_cast<std::ptrdiff_t>(v));
  const auto edges = feature_edges(complex, BoundarySurface(complex), positions.data());
  EXPECT_EQ(edges.size(), 2 * 8 + 5u) << "top and bottom, and the corners between them";
}

TEST(Crossing, IsWhereLinesAreNearest) {
  Crossing crossing;
  ASSERT_TRUE(find_crossing({{{0, 0, 1}, {4, 0, 1}}}, {{{1, -1, 0}, {1, 3, 0}}}, crossing));
  EXPECT_NEAR(crossing.first, 0.25, 1e-15);
  EXPECT_NEAR(crossing.second, 0.25, 1e-15);
  EXPECT_LT(norm(minus(crossing.offset, {0, 0, 1})), 1e-15);
  EXPECT_FALSE(find_crossing({{{0, 0, 1}, {4, 0, 1}}}, {{{1, 1, 0}, {3, 1.1, 0}}}, crossing));
}

}  // namespace
}  // namespace suture
