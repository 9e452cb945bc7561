// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "kernel/base/sort_unique.hpp"
#include "kernel/base/types.hpp"

namespace suture {

/// A union-find structure on positions 0, 1, ...; the smallest position represents its set.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::size_t i, std::size_t j) {
    i = find(i);
    j = find(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<std::size_t> parent_;
};

/// Groups numbers that are declared equal by pairs, in any order: each group is ascending, and the
/// groups are sorted by their smallest number. O(n log n).
inline std::vector<std::vector<Index>> groups_of_equal(
    const std::vector<std::pair<Index, Index>>& equal) {
  std::vector<Index> numbers;
  for (const auto& [a, b] : equal) numbers.insert(numbers.end(), {a, b});
  sort_unique(numbers);
  const auto place = [&](Index number) {
    return static_cast<std::size_t>(std::ranges::lower_bound(numbers, number) - numbers.begin());
  };
  DisjointSets sets(numbers.size());
  for (const auto& [a, b] : equal) sets.unite(place(a), place(b));
  std::vector<std::vector<Index>> all(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) all[sets.find(i)].push_back(numbers[i]);
  std::erase_if(all, [](const auto& group) { return group.size() < 2; });
  return all;
}

}  // namespace suture
