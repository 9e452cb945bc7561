// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/cut_patterns.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <random>
#include <set>

#include "kernel/parts/moments.hpp"

namespace suture {
namespace {

using Shares = std::array<double, 64>;

std::array<Vec3, 4> corners_of(const CutPattern& pattern, const std::array<std::uint8_t, 4>& t,
                               const Shares& shares) {
  std::array<Vec3, 4> corners;
  for (std::size_t i = 0; i < 4; ++i)
    corners[i] = place_of(pattern.points[t[i]], shares[pattern.points[t[i]]]);
  return corners;
}

double volume_of(CornerSet inside, const Shares& shares) {
  double volume = 0;
  for (const auto& t : cut_pattern(inside).tetrahedra)
    volume += six_volumes(corners_of(cut_pattern(inside), t, shares)) / 6;
  return volume;
}

Shares random_shares(std::mt19937& random) {
  std::uniform_real_distribution<double> share(0.02, 0.98);
  Shares shares;
  for (double& s : shares) s = share(random);
  return shares;
}

TEST(CutPatterns, FullAndEmptyCubes) {
  EXPECT_TRUE(cut_pattern(0).tetrahedra.empty());
  EXPECT_EQ(cut_pattern(all_corners).tetrahedra.size(), 6u);
  EXPECT_TRUE(cut_pattern(all_corners).triangles.empty());
  EXPECT_DOUBLE_EQ(volume_of(all_corners, {}), 8);
}

// Wherever the edges are crossed: no tetrahedron is inverted, and a pattern and that of the other
// corners fill the cube, with the same surface between them.
TEST(CutPatterns, InnerAndOuterPartsFillTheCube) {
  const unsigned seed = 20261;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 20; ++round) {
    const Shares shares = random_shares(random);
    for (unsigned set = 0; set < 256; ++set) {
      const auto inside = static_cast<CornerSet>(set), outside = static_cast<CornerSet>(~set);
      for (const auto& t : cut_pattern(inside).tetrahedra)
        ASSERT_GT(six_volumes(corners_of(cut_pattern(inside), t, shares)), 0) << set;
      EXPECT_NEAR(volume_of(inside, shares) + volume_of(outside, shares), 8, 1e-14) << set;
      EXPECT_EQ(cut_pattern(inside).triangles.size(), cut_pattern(outside).triangles.size());
    }
  }
}

// Each face of a tetrahedron is that of another one, of the surface, or on a side of the cube;
// those of the surface are all of them.
TEST(CutPatterns, FacesMatch) {
  for (unsigned set = 0; set < 256; ++set) {
    const CutPattern& pattern = cut_pattern(static_cast<CornerSet>(set));
    std::map<std::set<int>, int> times;
    for (const auto& t : pattern.tetrahedra)
      for (int left = 0; left < 4; ++left) {
        std::set<int> face(t.begin(), t.end());
        face.erase(t[left]);
        ++times[face];
      }
    for (const auto& t : pattern.triangles) ++times[std::set<int>(t.begin(), t.end())];
    for (const auto& [face, count] : times) {
      bool on_side = false;
      for (int a = 0; a < 3; ++a)
        for (const double side : {-1, 1}) {
          bool all = true;
          for (const int p : face) all = all && place_of(pattern.points[p], 0.5)[a] == side;
          on_side = on_side || all;
        }
      EXPECT_EQ(count, on_side ? 1 : 2) << set;
    }
  }
}

// The part on the upper side of one cube is that on the lower side of the next one.
TEST(CutPatterns, SidesOfNeighboursMatch) {
  const unsigned seed = 20262;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  using Face = std::set<std::array<int, 2>>;  // low corner and direction of each point
  const auto faces_on = [](CornerSet inside, unsigned axis, bool upper) {
    std::set<Face> faces;
    const CutPattern& pattern = cut_pattern(inside);
    for (const auto& t : pattern.tetrahedra)
      for (int left = 0; left < 4; ++left) {
        Face face;
        for (int i = 0; i < 4; ++i) {
          const PatternPoint p = pattern.points[t[i]];
          if (i == left || place_of(p, 0.5)[axis] != (upper ? 1 : -1)) continue;
          face.insert({int(low_corner(p) & ~(1u << axis)), int(direction(p))});
        }
        if (face.size() == 3) faces.insert(face);
      }
    return faces;
  };
  for (int round = 0; round < 3000; ++round) {
    const auto below = static_cast<CornerSet>(random());
    for (unsigned axis = 0; axis < 3; ++axis) {
      auto above = static_cast<CornerSet>(random());
      for (unsigned n = 0; n < 8; ++n)
        if ((n >> axis & 1) == 0) {
          above &= CornerSet(~(1u << n));
          above |= CornerSet((below >> (n | 1u << axis) & 1) << n);
        }
      ASSERT_EQ(faces_on(below, axis, true), faces_on(above, axis, false));
    }
  }
}

TEST(CutPatterns, PartsAreConnectedByEdgesOfTheTetrahedra) {
  EXPECT_EQ(connected_parts(0), std::vector<CornerSet>{});
  EXPECT_EQ(connected_parts(all_corners), std::vector<CornerSet>{all_corners});
  // X0 and X7 are the ends of the diagonal; X1 and X6 are not.
  EXPECT_EQ(connected_parts(0b10000001), std::vector<CornerSet>{0b10000001});
  EXPECT_EQ(connected_parts(0b01000010), (std::vector<CornerSet>{0b00000010, 0b01000000}));
  EXPECT_EQ(connected_parts(0b00010110), (std::vector<CornerSet>{0b10, 0b100, 0b10000}));
  // The parts together have the tetrahedra of the whole.
  for (unsigned set = 0; set < 256; ++set) {
    std::size_t tetrahedra = 0, triangles = 0;
    for (const CornerSet part : connected_parts(static_cast<CornerSet>(set))) {
      tetrahedra += cut_pattern(part).tetrahedra.size();
      triangles += cut_pattern(part).triangles.size();
    }
    EXPECT_EQ(tetrahedra, cut_pattern(static_cast<CornerSet>(set)).tetrahedra.size());
    EXPECT_EQ(triangles, cut_pattern(static_cast<CornerSet>(set)).triangles.size());
  }
}

// Against sums over the points of a fine lattice.
TEST(CutPatterns, MomentsAreThoseOfTheMaterial) {
  const unsigned seed = 20263;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (const CornerSet inside : {0b1, 0b10, 0b11, 0b10010110, 0b01111111}) {
    const Shares shares = random_shares(random);
    const CutPattern& pattern = cut_pattern(inside);
    MomentSum sum;
    double volume = 0;
    Vec3 first{}, second{};
    for (const auto& t : pattern.tetrahedra) {
      const std::array<Vec3, 4> x = corners_of(pattern, t, shares);
      sum.add(x);
      // Four points of degree 2 (Hammer & Stroud): another way to the same integrals.
      const double v = six_volumes(x) / 6, near = 0.5854101966249685, far = 0.1381966011250105;
      for (int q = 0; q < 4; ++q) {
        Vec3 p{};
        for (int i = 0; i < 4; ++i)
          for (int a = 0; a < 3; ++a) p[a] += (i == q ? near : far) * x[i][a];
        volume += v / 4;
        for (int a = 0; a < 3; ++a) {
          first[a] += v / 4 * p[a];
          second[a] += v / 4 * p[(a + 1) % 3] * p[(a + 2) % 3];
        }
      }
    }
    const PartMoments found = sum.moments();
    EXPECT_NEAR(found.fraction, volume / 8, 1e-14);
    for (int a = 0; a < 3; ++a) {
      EXPECT_NEAR(found.centroid[a], first[a] / volume, 1e-13);
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      EXPECT_NEAR(found.covariance[a], second[a] / volume - first[b] * first[c] / volume / volume,
                  1e-13);
    }
  }
}

}  // namespace
}  // namespace suture
