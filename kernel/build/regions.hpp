// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "kernel/base/box.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/geometry/element_blocks.hpp"
#include "kernel/scene/selection.hpp"

// The geometry of selections, which knows places but no mesh.

namespace suture {

/// Whether a point lies in a selection by place. `diagonal`: of the mesh, m. False for selections
/// by ids, by a set, or of the nearest cell.
bool lies_in(const Selection& region, const Vec3& p, double diagonal);
/// False only if no point of the box lies in such a selection.
bool may_hold_some(const Selection& region, const Box& box, double diagonal);

/// The least distance of a box from a point, rounded down.
inline double least_distance(const Box& box, const Vec3& p) {
  Vec3 beside;
  for (std::size_t a = 0; a < 3; ++a)
    beside[a] = std::max({box.low[a] - p[a], 0.0, p[a] - box.high[a]});
  return (1 - 1e-14) * norm(beside);
}

/// The first of those cells that are as near to a point as the nearest one, to within the tie.
class NearestSearch {
 public:
  explicit NearestSearch(const Selection::Nearest& wanted) : wanted_(wanted) {}

  /// Looks at large blocks from the nearest one on, and so at the smaller ones of each.
  template <class Place>
  void look(const ElementBlocks* blocks, Index count, Place place) {
    if (!blocks) return look_at(0, count, place);
    look_in(*blocks, 0, 0, count, place);
  }

  std::vector<Index> found() const {
    Index first = none;
    for (const auto& [distance, cell] : candidates_)
      if (distance <= nearest_ + wanted_.tie) first = std::min(first, cell);
    return first == none ? std::vector<Index>{} : std::vector{first};
  }

 private:
  template <class Place>
  void look_in(const ElementBlocks& blocks, std::size_t level, Index begin, Index end,
               Place place) {
    const Index size = ElementBlocks::sizes[level];
    const auto box = [&](Index block) { return blocks.box(level, block); };
    by_distance(begin / size, blocks_of(end, size), box, [&](Index block) {
      const Index first = block * size, last = std::min(first + size, end);
      if (level + 1 < ElementBlocks::levels)
        look_in(blocks, level + 1, first, last, place);
      else
        look_at(first, last, place);
    });
  }
  /// Calls visit(i) from the nearest box(i) on, up to those that are too far away.
  template <class BoxOf, class Visit>
  void by_distance(Index first, Index last, BoxOf box, Visit visit) {
    std::vector<std::pair<double, Index>> order;
    for (Index i = first; i < last; ++i)
      order.emplace_back(least_distance(box(i), wanted_.point), i);
    std::ranges::sort(order);
    for (const auto& [distance, i] : order) {
      if (distance > nearest_ + wanted_.tie) break;
      visit(i);
    }
  }
  template <class Place>
  void look_at(Index first, Index last, Place place) {
    for (Index cell = first; cell < last; ++cell)
      if (const std::optional<Vec3> p = place(cell)) add(cell, norm(minus(*p, wanted_.point)));
  }
  void add(Index cell, double distance) {
    if (!(distance <= nearest_ + wanted_.tie)) return;
    nearest_ = std::min(nearest_, distance);
    candidates_.emplace_back(distance, cell);
  }

  const Selection::Nearest& wanted_;
  double nearest_ = std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, Index>> candidates_;
};

}  // namespace suture
