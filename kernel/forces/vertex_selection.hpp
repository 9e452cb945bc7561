// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/base/zeroed_indices.hpp"

namespace suture {

/// A subset of the vertices, numbered in the given order. 4 B per vertex of the complex, kept
/// between selections.
class VertexSelection {
 public:
  /// Each vertex at most once. O(vertices).
  void select(std::span<const Index> vertices, Index vertex_count) {
    slot_.reserve(vertex_count);
    selected_.assign(vertices.begin(), vertices.end());
    for (std::size_t i = 0; i < selected_.size(); ++i) slot_[selected_[i]] = static_cast<Index>(i);
  }
  bool contains(Index vertex) const { return slot(vertex) != none; }
  /// `none` if it is not selected.
  Index slot(Index vertex) const {
    const Index slot = slot_[vertex];
    return slot < selected_.size() && selected_[slot] == vertex ? slot : none;
  }

 private:
  ZeroedIndices slot_;  ///< of the vertices that were ever selected
  std::vector<Index> selected_;
};

}  // namespace suture
