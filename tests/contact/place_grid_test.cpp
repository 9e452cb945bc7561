// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/place_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace suture {
namespace {

TEST(PlaceGrid, FindsThoseOfASearchOfAllPlaces) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> at(-2, 2), size(0, 1);
  std::vector<PlaceGrid::Entry> entries;
  for (Index i = 0; i < 500; ++i)
    entries.push_back({{at(random), at(random), at(random)}, i, i % 3});
  PlaceGrid grid(entries, 0.4, 4);
  std::size_t count = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 middle{at(random), at(random), at(random)};
    const Box box = enlarged({middle, middle}, size(random));
    const Index except = trial % 4 == 3 ? none : Index(trial % 4);
    std::vector<Index> expected;
    for (const PlaceGrid::Entry& entry : entries) {
      bool inside = entry.piece != except;
      for (std::size_t c = 0; c < 3; ++c)
        inside &= entry.place[c] >= box.low[c] && entry.place[c] <= box.high[c];
      if (inside) expected.push_back(entry.item);
    }
    const auto found = grid.find(box, except);
    std::vector<Index> items(found.begin(), found.end());
    std::ranges::sort(items);
    items.erase(std::unique(items.begin(), items.end()), items.end());
    ASSERT_EQ(items, expected) << trial;
    count += items.size();
  }
  EXPECT_GT(count, 1000u);
}

}  // namespace
}  // namespace suture
