// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/place_grid.hpp"

#include <bit>

namespace suture {

/// Sorted by counting.
PlaceGrid::PlaceGrid(std::span<const Entry> entries, double cell, double before)
    : per_cell_(1 / cell), start_(std::bit_ceil(entries.size() + 1) + 1) {
  Box box = no_box;
  for (const Entry& entry : entries) include(box, entry.place);
  for (std::size_t c = 0; c < 3; ++c) origin_[c] = box.low[c] - before;
  std::vector<Index> slots(entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    slots[i] = static_cast<Index>(slot(cube(entries[i].place)));
    ++start_[slots[i] + 1];
  }
  for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
  std::vector<Index> next(start_.begin(), start_.end() - 1);
  entries_.resize(entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) entries_[next[slots[i]]++] = entries[i];
}

}  // namespace suture
