// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/near_edges.hpp"

#include <gtest/gtest.h>

#include "kernel/base/rows.hpp"
#include "kernel/base/vec3.hpp"
#include "tests/contact/soup.hpp"

namespace suture {
namespace {

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
