// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/disjoint_sets.hpp"

#include <gtest/gtest.h>

#include <random>

namespace suture {
namespace {

/// Against sets that are relabelled one by one.
TEST(DisjointSets, AreThoseOfRelabelling) {
  std::mt19937 random(1);
  constexpr std::size_t count = 60;
  DisjointSets sets(count);
  std::vector<std::size_t> label(count);
  std::iota(label.begin(), label.end(), std::size_t{0});
  std::vector<std::pair<Index, Index>> pairs;
  for (int i = 0; i < 40; ++i) {
    const std::size_t a = random() % count, b = random() % count;
    sets.unite(a, b);
    pairs.emplace_back(Index(a), Index(b));
    const std::size_t low = std::min(label[a], label[b]), high = std::max(label[a], label[b]);
    std::ranges::replace(label, high, low);
    for (std::size_t k = 0; k < count; ++k) ASSERT_EQ(sets.find(k), label[k]);
  }
  std::vector<std::vector<Index>> groups(count);
  for (Index k = 0; k < count; ++k) groups[label[k]].push_back(k);
  std::erase_if(groups, [](const auto& group) { return group.size() < 2; });
  EXPECT_EQ(groups_of_equal(pairs), groups);
}

}  // namespace
}  // namespace suture
