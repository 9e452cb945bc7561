// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/base/types.hpp"

namespace suture {

/// A subset of the vertices, numbered in the given order. 4 B per vertex of the complex, kept
/// between selections.
class VertexSelection {
 public:
  /// Each vertex at most once. O(vertices); the first call O(all vertices).
  void select(std::span<const Index> vertices, Index vertex_count) {
    for (const Index v : selected_) slot_[v] = none;
    if (slot_.size() < vertex_count) slot_.resize(vertex_count, none);
    selected_.assign(vertices.begin(), vertices.end());
    for (std::size_t i = 0; i < selected_.size(); ++i) slot_[selected_[i]] = static_cast<Index>(i);
  }
  bool contains(Index vertex) const { return slot_[vertex] != none; }
  Index slot(Index vertex) const { return slot_[vertex]; }  ///< `none` if it is not selected

 private:
  std::vector<Index> slot_, selected_;
};

}  // namespace suture
