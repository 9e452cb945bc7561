// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// Whether a change reports every cell whose star differs, with the star it has
/// afterwards, and every removed cell, while the others are as they were.
class ChangeCheck {
 public:
  /// What is not reported, or reported wrongly: the first offence, or "".
  static std::string offence(const CellComplex& before, const CellComplex& after,
                             const TopologyChange& change) {
    ChangeCheck check(before, after, change);
    for (int dimension = 0; dimension < 3; ++dimension) check.dimension(dimension);
    for (const Index e : check.gone(3)) check.expect(!after.exists(3, e), 3, e, "is not removed");
    check.expect(
        after.existing(3) + change.removed[3].size() == before.existing(3) + change.copies.size(),
        3, none, "removed elements are not counted");
    check.expect(std::ranges::equal(change.elements, check.elements_), 3, none,
                 "the elements are not those of the stars");
    return check.offence_;
  }

 private:
  ChangeCheck(const CellComplex& before, const CellComplex& after, const TopologyChange& change)
      : before_(before), after_(after), change_(change) {}

  void expect(bool holds, int dimension, Index id, const std::string& what) {
    if (holds || !offence_.empty()) return;
    offence_ = "change: dimension " + std::to_string(dimension) +
               (id == none ? "" : ", cell " + std::to_string(id)) + ": " + what;
  }

  void dimension(int d) {
    const std::set<Index> gone_cells = gone(d), reported = stars(d);
    for (Index id = 0; id < after_.count(d); ++id) {
      if (reported.contains(id)) continue;
      expect(id < before_.count(d), d, id, "a new cell without a star");
      if (id >= before_.count(d)) return;
      expect(after_.exists(d, id) == (before_.exists(d, id) && !gone_cells.contains(id)), d, id,
             "was added or removed without a report");
      if (!after_.exists(d, id)) continue;
      before_.star(d, id, old_star_);
      after_.star(d, id, new_star_);
      expect(old_star_ == new_star_, d, id, "has another star without a report");
    }
    splits(d, gone_cells.size());
  }

  std::set<Index> stars(int d) {
    std::set<Index> reported;
    const Stars& stars = change_.stars[static_cast<std::size_t>(d)];
    for (std::size_t i = 0; i < stars.size(); ++i) {
      const Index id = stars.cells[i];
      expect(reported.insert(id).second, d, id, "two stars");
      expect(after_.exists(d, id), d, id, "a star of a cell that is not there");
      if (!offence_.empty()) return reported;
      after_.star(d, id, new_star_);
      expect(std::ranges::equal(stars[i], new_star_), d, id, "not the star of the map");
      expect(stars[i][0] == after_.dart_of(d, id), d, id, "dart_of is not the first");
      for (const Dart dart : stars[i]) elements_.insert(dart / 24);
      if (id >= before_.count(d)) continue;
      before_.star(d, id, old_star_);
      expect(old_star_ != new_star_, d, id, "reported without need");
    }
    return reported;
  }

  /// The cells that are said to be no more.
  std::set<Index> gone(int d) {
    const std::vector<Index>& removed = change_.removed[static_cast<std::size_t>(d)];
    expect(std::ranges::is_sorted(removed), d, none, "removed cells not ascending");
    std::set<Index> result(removed.begin(), removed.end());
    expect(result.size() == removed.size(), d, none, "removed twice");
    if (d == 3) return result;
    const std::vector<Merge>& merges = change_.merges[static_cast<std::size_t>(d)];
    const auto pair = [](const Merge& m) { return std::pair(m.kept, m.gone); };
    expect(std::ranges::is_sorted(merges, {}, pair), d, none, "merges not in order");
    for (const Merge& m : merges) {
      expect(m.kept < m.gone, d, m.gone, "is smaller than the cell kept");
      expect(result.insert(m.gone).second, d, m.gone, "gone twice");
    }
    for (const Merge& m : merges) expect(!result.contains(m.kept), d, m.kept, "kept and gone");
    return result;
  }

  void splits(int d, std::size_t gone_cells) {
    const auto& splits = change_.splits[static_cast<std::size_t>(d)];
    Index next = before_.count(d);
    for (const Split& split : splits) {
      expect(split.new_cell == next++, d, split.new_cell, "new numbers are not consecutive");
      expect(split.old_cell < before_.count(d), d, split.old_cell, "a new cell that splits");
    }
    expect(next == after_.count(d), d, none, "new cells without a split");
    expect(after_.existing(d) + gone_cells == before_.existing(d) + splits.size(), d, none,
           "cells are not counted");
  }

  const CellComplex &before_, &after_;
  const TopologyChange& change_;
  std::set<Index> elements_;
  std::vector<Dart> old_star_, new_star_;
  std::string offence_;
};

inline void expect_change_tells_all(const CellComplex& before, const CellComplex& after,
                                    const TopologyChange& change) {
  EXPECT_EQ(ChangeCheck::offence(before, after, change), "");
}

}  // namespace suture
