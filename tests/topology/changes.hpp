// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// The cells of one dimension that a change says are no more, checked for its order.
inline std::set<Index> expect_told_gone(const TopologyChange& change, int dimension) {
  std::set<Index> gone(change.removed[dimension].begin(), change.removed[dimension].end());
  EXPECT_EQ(gone.size(), change.removed[dimension].size());
  EXPECT_TRUE(std::ranges::is_sorted(change.removed[dimension]));
  if (dimension == 3) return gone;
  const auto& merges = change.merges[dimension];
  EXPECT_TRUE(
      std::ranges::is_sorted(merges, {}, [](const Merge& m) { return std::pair(m.kept, m.gone); }));
  for (const Merge& merge : merges) {
    EXPECT_LT(merge.kept, merge.gone);
    EXPECT_TRUE(gone.insert(merge.gone).second);
  }
  for (const Merge& merge : merges) EXPECT_FALSE(gone.contains(merge.kept));
  return gone;
}

/// A change tells every cell whose star differs, with the star it has afterwards, and
/// every cell that is no more; the others are as they were.
inline void expect_change_tells_all(const CellComplex& before, const CellComplex& after,
                                    const TopologyChange& change) {
  std::set<Index> elements;
  for (int dimension = 0; dimension < 3; ++dimension) {
    SCOPED_TRACE("dimension " + std::to_string(dimension));
    std::set<Index> told;
    std::vector<Dart> old_star, new_star;
    const std::set<Index> gone = expect_told_gone(change, dimension);
    for (std::size_t i = 0; i < change.stars[dimension].size(); ++i) {
      const Index id = change.stars[dimension].cells[i];
      EXPECT_TRUE(told.insert(id).second);
      ASSERT_TRUE(after.exists(dimension, id));
      after.star(dimension, id, new_star);
      const auto star = change.stars[dimension][i];
      EXPECT_TRUE(std::ranges::equal(star, new_star)) << "cell " << id;
      EXPECT_EQ(star[0], after.dart_of(dimension, id));
      for (const Dart d : star) elements.insert(d / 24);
      if (id >= before.count(dimension)) continue;
      before.star(dimension, id, old_star);
      EXPECT_NE(old_star, new_star);
    }
    for (Index id = 0; id < after.count(dimension); ++id) {
      if (told.contains(id)) continue;
      ASSERT_LT(id, before.count(dimension));
      EXPECT_EQ(after.exists(dimension, id), before.exists(dimension, id) && !gone.contains(id));
      if (!after.exists(dimension, id)) continue;
      before.star(dimension, id, old_star);
      after.star(dimension, id, new_star);
      EXPECT_EQ(old_star, new_star);
    }
    Index next = before.count(dimension);
    for (const Split& split : change.splits[dimension]) {
      EXPECT_EQ(split.new_cell, next++);
      EXPECT_LT(split.old_cell, before.count(dimension));
    }
    EXPECT_EQ(next, after.count(dimension));
    EXPECT_EQ(after.existing(dimension),
              before.existing(dimension) + change.splits[dimension].size() - gone.size());
  }
  EXPECT_EQ(after.existing(3), before.existing(3) - expect_told_gone(change, 3).size());
  for (const Index e : change.removed[3]) EXPECT_FALSE(after.exists(3, e));
  EXPECT_TRUE(std::ranges::equal(change.elements, elements));
}

}  // namespace suture
