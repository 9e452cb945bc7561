// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/attributes/table.hpp"
#include "kernel/base/zeroed_indices.hpp"

namespace suture {

/// The elements of one region that an operation touched, numbered 0, 1, ... in
/// ascending order, so that values per touched element are contiguous and are found
/// from a dart without a search. One table over all elements, never cleared: only
/// entries of elements in the change are read. Kept between operations.
class TouchedElements {
 public:
  void reserve(Index element_count) { slot_.reserve(element_count); }

  /// `changed`: TopologyChange::elements. O(changed).
  void select(const CellSet& region, std::span<const Index> changed) {
    members_.clear();
    for (const Index e : changed) {
      const bool inside = region.contains(e);
      slot_[e] = inside ? static_cast<Index>(members_.size()) : none;
      if (inside) members_.push_back(e);
    }
  }

  std::span<const Index> members() const { return members_; }
  /// Number of a changed element among members(), or `none` outside the region.
  Index slot(Index element) const { return slot_[element]; }

 private:
  ZeroedIndices slot_;
  std::vector<Index> members_;
};

}  // namespace suture
