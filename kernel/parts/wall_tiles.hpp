// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/parts/cell_sets.hpp"

namespace suture {

/// What stays as it is, by cell, wall and point.
struct FixedParts {
  std::vector<std::uint8_t> cells, walls, points;
};

/// Walls in one plane between the same two cells.
struct WallTile {
  std::vector<Index> walls;
  std::vector<Triangle> triangles;  ///< as seen from outside `cell`
  Index cell = none;                ///< represents a set
  bool is_changed = false;
};

/// Unites walls into tiles, and divides these into triangles without the points in the middle of
/// their edges.
class WallTiles {
 public:
  WallTiles(const PartWalls& map, CellSets& sets, FixedParts& fixed)
      : map_(map), walls_(map.walls()), sets_(sets), fixed_(fixed) {}
  /// False if there are tiles that cannot be divided so: their walls are fixed then.
  bool find() {
    find_tiles();
    return find_corners();
  }
  const std::vector<WallTile>& all() const { return tiles_; }

 private:
  using Tile = WallTile;
  struct Edge {
    Index low, high, wall;
    auto operator<=>(const Edge&) const = default;
  };
  bool stays(Index wall) const;
  bool are_alike(const PartWalls::Wall& one, const PartWalls::Wall& other);
  bool are_coplanar(Index one, Index other) const;
  void find_tiles();
  std::vector<Index> border(Tile& tile);
  std::vector<std::uint8_t> corners() const;
  bool find_corners();

  const PartWalls& map_;
  const std::vector<PartWalls::Wall>& walls_;
  CellSets& sets_;
  FixedParts& fixed_;
  std::vector<Edge> edges_;  ///< between tiles
  std::vector<Tile> tiles_;
};

}  // namespace suture
