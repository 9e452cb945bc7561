// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/near_pairs.hpp"

#include <gtest/gtest.h>

#include <random>

#include "kernel/base/rows.hpp"
#include "tests/contact/soup.hpp"

namespace suture {
namespace {

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

}  // namespace
}  // namespace suture
