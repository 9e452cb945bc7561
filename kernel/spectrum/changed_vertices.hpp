// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "kernel/base/archive.hpp"
#include "kernel/topology/cell_complex.hpp"
#include "kernel/topology/marks.hpp"

namespace suture {

/// Vertices whose bounds for the stable step may have grown since the last call of take(): they
/// lost mass or cells, their cells have different columns, or a merge moved a corner. One bit per
/// vertex.
class ChangedVertices {
 public:
  /// Bounds of functors on elements that read no vertex columns depend only on the elements and
  /// mass of the vertex, so only vertices that lost or gained elements are added. `columns_count`:
  /// some functor is on edges or faces or reads vertex columns, which may have changed at every
  /// vertex of the affected elements. O(change).
  void add(const CellComplex& complex, const TopologyChange& change, bool columns_count) {
    marks_.resize(complex.count(0) / 64 + 1, 0);
    for (const Index v : change.stars[0].cells) add(v);
    if (!columns_count && change.faces_sewn == 0) return;
    for (const Index e : change.elements)
      for (const Index v : complex.vertices_of(e)) add(v);
  }

  /// Returns the changed vertices that exist, ascending, and clears the set.
  std::vector<Index> take(const CellComplex& complex) {
    marks::unmark(marks_, vertices_);
    std::erase_if(vertices_, [&](Index v) { return !complex.exists(0, v); });
    std::ranges::sort(vertices_);
    return std::exchange(vertices_, {});
  }

  void state(Archive& archive) {
    archive("marks", marks_);
    archive("vertices", vertices_);
  }

 private:
  void add(Index vertex) {
    if (vertex != none && marks::mark(marks_, vertex)) vertices_.push_back(vertex);
  }

  std::vector<std::uint64_t> marks_;
  std::vector<Index> vertices_;
};

}  // namespace suture
