// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/wall_tiles.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/base/vec3.hpp"
#include "kernel/parts/flat_polygon.hpp"

namespace suture {
namespace {

constexpr double place_rounding = 1e-12;  // in the reference cube

}  // namespace

bool WallTiles::stays(Index wall) const {
  if (walls_[wall].count > 2 || fixed_.walls[wall] != 0) return true;
  return std::ranges::any_of(walls_[wall].known_sides(), [&](const PartWalls::Side& side) {
    return fixed_.cells[map_.cell_of(side)] != 0;
  });
}

/// The same cells on both sides, which are shown in the same way.
bool WallTiles::are_alike(const PartWalls::Wall& one, const PartWalls::Wall& other) {
  if (one.count != other.count) return false;
  const auto alike = [&](unsigned s, unsigned r) {
    return sets_.root(one.sides[s]) == sets_.root(other.sides[r]) &&
           one.sides[s].mark == other.sides[r].mark;
  };
  return one.count == 1 ? alike(0, 0)
                        : (alike(0, 0) && alike(1, 1)) || (alike(0, 1) && alike(1, 0));
}

bool WallTiles::are_coplanar(Index one, Index other) const {
  const Index element = map_.element_of(walls_[one].sides[0]);
  const auto points = [&](Index wall) {
    const auto& [a, b, c] = map_.points_of(wall);
    return std::array<Vec3, 3>{map_.place(element, a), map_.place(element, b),
                               map_.place(element, c)};
  };
  for (const Index w : {one, other})
    for (const Index p : map_.points_of(w))
      if (!map_.has(element, p)) return false;
  std::array<Vec3, 3> large = points(one), small = points(other);
  Vec3 normal = cross(minus(large[1], large[0]), minus(large[2], large[0]));
  const Vec3 second = cross(minus(small[1], small[0]), minus(small[2], small[0]));
  if (norm(second) > norm(normal)) {
    normal = second;
    large.swap(small);
  }
  const double size = norm(normal);
  for (const Vec3& p : small)
    if (std::abs(dot(normal, minus(p, large[0]))) > place_rounding * size) return false;
  return true;
}

void WallTiles::find_tiles() {
  std::vector<Edge> edges;
  for (Index w = 0; w < walls_.size(); ++w) {
    if (!sets_.is_wall(walls_[w])) continue;
    const auto& [a, b, c] = map_.points_of(w);  // ascending
    edges.insert(edges.end(), {{a, b, w}, {a, c, w}, {b, c, w}});
  }
  std::ranges::sort(edges);
  DisjointSets tiles(walls_.size());
  edges_.clear();
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    const auto& [a, b, one] = edges[i];
    while (end < edges.size() && edges[end].low == a && edges[end].high == b) ++end;
    if (end - i == 2) {
      const Index other = edges[i + 1].wall;
      if ((map_.is_wanted(walls_[one]) || map_.is_wanted(walls_[other])) && !stays(one) &&
          !stays(other) && are_alike(walls_[one], walls_[other]) && are_coplanar(one, other) &&
          !map_.is_kept(a, b)) {
        tiles.unite(one, other);
        continue;
      }
    }
    edges_.push_back(edges[i]);
  }
  tiles_.clear();
  std::vector<Index> tile_of(walls_.size(), none);
  for (Index w = 0; w < walls_.size(); ++w) {
    if (!sets_.is_wall(walls_[w])) continue;
    const std::size_t first = tiles.find(w);
    if (first == w) {
      tile_of[w] = static_cast<Index>(tiles_.size());
      tiles_.emplace_back();
    } else {
      tile_of[w] = tile_of[first];
    }
    tiles_[tile_of[w]].walls.push_back(w);
  }
}

/// Returns the border of a tile as seen from outside its cell; empty if it is not one loop.
std::vector<Index> WallTiles::border(Tile& tile) {
  std::vector<std::pair<Index, Index>> directed;
  tile.cell = sets_.root(walls_[tile.walls[0]].sides[0]);
  for (const Index w : tile.walls) {
    const PartWalls::Wall& wall = walls_[w];
    const Triangle& t =
        sets_.root(wall.sides[0]) == tile.cell ? wall.sides[0].outward : wall.sides[1].outward;
    for (std::size_t c = 0; c < 3; ++c) directed.emplace_back(t[c], t[(c + 1) % 3]);
  }
  std::ranges::sort(directed);
  std::vector<std::pair<Index, Index>> outer;
  for (const auto& [a, b] : directed)
    if (!std::ranges::binary_search(directed, std::pair(b, a))) outer.emplace_back(a, b);
  std::vector<Index> loop;
  Index at = outer.empty() ? none : outer[0].first;
  for (std::size_t i = 0; i < outer.size(); ++i) {
    const auto next = std::ranges::lower_bound(outer, std::pair(at, Index{0}));
    if (next == outer.end() || next->first != at) return {};
    if (next + 1 != outer.end() && (next + 1)->first == at) return {};
    if (i > 0 && at == outer[0].first) return {};  // there is another loop
    loop.push_back(at);
    at = next->second;
  }
  if (loop.empty() || at != loop[0]) return {};
  return loop;
}

/// By point: 0 if no tile needs it.
std::vector<std::uint8_t> WallTiles::corners() const {
  struct Point {
    unsigned edges = 0;
    std::array<Index, 2> to{none, none};
    Index element = none;
    bool stays = true;
  };
  std::vector<Point> points(map_.point_count());
  for (const auto& [a, b, wall] : edges_) {
    const auto join = [&](Index from, Index to) {
      Point& point = points[from];
      if (point.edges < 2) point.to[point.edges] = to;
      ++point.edges;
    };
    join(a, b);
    join(b, a);
  }
  for (const Tile& tile : tiles_)
    for (const Index w : tile.walls)
      for (const Index p : map_.points_of(w)) {
        points[p].element = map_.element_of(walls_[w].sides[0]);
        if (map_.is_wanted(walls_[w])) points[p].stays = false;
      }
  for (const Tile& tile : tiles_)
    for (const Index w : tile.walls)
      if (stays(w))
        for (const Index p : map_.points_of(w)) points[p].stays = true;
  std::vector<std::uint8_t> is_corner(points.size(), 1);
  for (Index p = 0; p < points.size(); ++p) {
    const Point& point = points[p];
    if (point.edges != 2 || point.stays || map_.is_kept(p) || fixed_.points[p] != 0) continue;
    if (!map_.has(point.element, point.to[0]) || !map_.has(point.element, point.to[1])) continue;
    const Vec3 here = map_.place(point.element, p),
               a = minus(map_.place(point.element, point.to[0]), here),
               b = minus(map_.place(point.element, point.to[1]), here), line = minus(b, a);
    if (dot(a, b) < 0 && norm(cross(a, line)) <= place_rounding * norm(line)) is_corner[p] = 0;
  }
  return is_corner;
}

/// Divides each tile anew, without the points that are no corners.
bool WallTiles::find_corners() {
  const std::vector<std::uint8_t> is_corner = corners();
  bool is_done = true;
  for (Tile& tile : tiles_) {
    const std::vector<Index> loop = border(tile);
    std::vector<Index> polygon;
    for (const Index p : loop)
      if (is_corner[p] != 0) polygon.push_back(p);
    const PartWalls::Wall& first = walls_[tile.walls[0]];
    const bool is_as_before =
        !loop.empty() && polygon.size() == loop.size() && tile.walls.size() == loop.size() - 2;
    if (is_as_before || tile.walls.size() == 1) {
      for (const Index w : tile.walls) {
        const PartWalls::Wall& wall = walls_[w];
        tile.triangles.push_back(sets_.root(wall.sides[0]) == tile.cell ? wall.sides[0].outward
                                                                        : wall.sides[1].outward);
      }
      if (is_as_before) continue;
      tile.triangles.clear();
    }
    std::vector<Vec3> at;
    const Index element = map_.element_of(first.sides[0]);
    for (const Index p : polygon) at.push_back(map_.place(element, p));
    tile.triangles = triangulated(polygon, at);
    tile.is_changed = true;
    if (!tile.triangles.empty()) continue;
    is_done = false;
    for (const Index w : tile.walls) {
      fixed_.walls[w] = 1;
      for (const Index p : map_.points_of(w)) fixed_.points[p] = 1;
    }
  }
  return is_done;
}

}  // namespace suture
