// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/parts/part_walls.hpp"
#include "kernel/topology/disjoint_sets.hpp"

namespace suture {

/// Cells of one wanted element and one Kuhn tetrahedron that become one, as their union is convex,
/// or fills the tetrahedron. A set is represented by its first cell.
class CellSets {
 public:
  /// `is_frozen`: by cell; these stay alone.
  CellSets(const PartWalls& walls, const std::vector<std::uint8_t>& is_frozen)
      : walls_(walls), cells_(walls.cells()), sets_(cells_.size()) {
    unite_cells(is_frozen);
  }

  Index root(Index cell) { return static_cast<Index>(sets_.find(cell)); }
  Index root(const PartWalls::Side& side) { return root(walls_.cell_of(side)); }
  /// The cells of the set that a cell represents, ascending.
  std::vector<Index> members(Index cell);
  /// Whether it is still between two cells, or at one.
  bool is_wall(const PartWalls::Wall& wall) {
    return wall.count != 2 || root(wall.sides[0]) != root(wall.sides[1]);
  }

 private:
  void unite_cells(const std::vector<std::uint8_t>& is_frozen);
  bool are_convex(Index one, Index other);
  bool is_inside(const std::vector<Index>& mine, const std::vector<Index>& theirs, Index one,
                 Index other);

  const PartWalls& walls_;
  const std::vector<PartWalls::Cell>& cells_;
  DisjointSets sets_;
};

}  // namespace suture
