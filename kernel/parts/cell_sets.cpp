// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/cell_sets.hpp"

#include <algorithm>

#include "kernel/base/sort_unique.hpp"
#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

// A blade is moved into points nearer than 0.04 (blade_pieces.cpp), so walls may be bent by that.
constexpr double snap = 0.05;
constexpr double least_area = 1e-12;  // of a triangle whose plane counts

}  // namespace

void CellSets::unite_cells(const std::vector<std::uint8_t>& is_frozen) {
  constexpr double whole = 8 * (1 - 1e-9);  // six times the volume of a Kuhn tetrahedron
  std::vector<Index> sorted;
  for (Index c = 0; c < cells_.size(); ++c)
    if (walls_.elements()[cells_[c].element].is_wanted && is_frozen[c] == 0) sorted.push_back(c);
  const auto group = [&](Index c) { return std::pair(cells_[c].element, cells_[c].kuhn); };
  std::ranges::stable_sort(sorted, {}, group);
  for (std::size_t i = 0, end = 0; i < sorted.size(); i = end) {
    double volume = 0;
    while (end < sorted.size() && group(sorted[end]) == group(sorted[i]))
      volume += cells_[sorted[end++]].volume;
    for (std::size_t k = i + 1; k < end && volume >= whole; ++k) sets_.unite(sorted[i], sorted[k]);
  }
  std::vector<std::pair<Index, Index>> pairs;
  for (const PartWalls::Wall& wall : walls_.walls()) {
    if (wall.count != 2) continue;
    const Index a = walls_.cell_of(wall.sides[0]), b = walls_.cell_of(wall.sides[1]);
    if (group(a) == group(b) && walls_.elements()[cells_[a].element].is_wanted &&
        is_frozen[a] == 0 && is_frozen[b] == 0)
      pairs.push_back(std::minmax(a, b));
  }
  sort_unique(pairs);
  for (bool again = !pairs.empty(); again;) {
    again = false;
    for (const auto& [a, b] : pairs) {
      if (root(a) == root(b) || !are_convex(root(a), root(b))) continue;
      sets_.unite(a, b);
      again = true;
    }
  }
}

/// Whether no corner of either of two cells lies outside a face of the other, their common ones
/// left out.
bool CellSets::are_convex(Index one, Index other) {
  const std::vector<Index> mine = members(one), theirs = members(other);
  return is_inside(mine, theirs, one, other) && is_inside(theirs, mine, other, one);
}
std::vector<Index> CellSets::members(Index cell) {
  std::vector<Index> found;
  const Index element = cells_[cell].element;
  for (Index c = cell; c < cells_.size() && cells_[c].element == element; ++c)
    if (root(c) == cell) found.push_back(c);
  return found;
}
bool CellSets::is_inside(const std::vector<Index>& mine, const std::vector<Index>& theirs,
                         Index one, Index other) {
  std::vector<Index> points;
  for (const Index c : mine)
    for (const Index t : cells_[c].tetrahedra)
      points.insert(points.end(), walls_.tetrahedra()[t].corners.begin(),
                    walls_.tetrahedra()[t].corners.end());
  sort_unique(points);
  const Index element = cells_[one].element;
  for (const Index c : theirs)
    for (const Index w : cells_[c].walls) {
      const PartWalls::Wall& wall = walls_.walls()[w];
      if (wall.count > 2) return false;
      const unsigned s = walls_.cell_of(wall.sides[0]) == c ? 0 : 1;
      if (wall.count == 2) {
        const Index behind = root(wall.sides[1 - s]);
        if (behind == one || behind == other) continue;
      }
      const auto& [a, b, d] = wall.sides[s].outward;
      const Vec3 &pa = walls_.place(element, a), &pb = walls_.place(element, b),
                 &pd = walls_.place(element, d);
      const Vec3 normal = cross(minus(pb, pa), minus(pd, pa));
      const double size = norm(normal);
      if (size < least_area) continue;
      for (const Index p : points)
        if (dot(normal, minus(walls_.place(element, p), pa)) > snap * size) return false;
    }
  return true;
}

}  // namespace suture
