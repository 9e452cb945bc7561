// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernel/base/box.hpp"

namespace suture {

inline bool contains(const Box& box, const Vec3& p) {
  return p[0] >= box.low[0] && p[0] <= box.high[0] && p[1] >= box.low[1] && p[1] <= box.high[1] &&
         p[2] >= box.low[2] && p[2] <= box.high[2];
}
inline bool overlap(const Box& a, const Box& b) {
  return a.low[0] <= b.high[0] && b.low[0] <= a.high[0] && a.low[1] <= b.high[1] &&
         b.low[1] <= a.high[1] && a.low[2] <= b.high[2] && b.low[2] <= a.high[2];
}
/// By the same length on all sides.
inline Box enlarged(Box box, double by) {
  for (std::size_t c = 0; c < 3; ++c) {
    box.low[c] -= by;
    box.high[c] += by;
  }
  return box;
}

/// Places in cubes, in the order of the hash of their cube: that of its row along x, plus its
/// place in the row. So the cubes of a box are a few stretches of entries, which are in memory one
/// after the other; entries of other cubes among them are found to be outside the box.
class PlaceGrid {
 public:
  struct Entry {
    Vec3 place;
    Index item, piece;
  };

  /// `cell`: the edge of a cube. Boxes do not begin farther than `before` below all entries.
  PlaceGrid(std::span<const Entry> entries, double cell, double before);

  /// visit(entry) for those in a box, some more than once.
  template <class Visit>
  void for_each(const Box& box, Visit visit) const {
    const Cube low = cube(box.low), high = cube(box.high);
    const std::uint64_t length = high[0] - low[0] + 1, slots = start_.size() - 1;
    const std::uint64_t rows = (high[1] - low[1] + 1) * (high[2] - low[2] + 1);
    if (length >= slots || rows > slots) return scan(box, 0, slots, visit);
    for (std::uint64_t z = low[2]; z <= high[2]; ++z)
      for (std::uint64_t y = low[1]; y <= high[1]; ++y) {
        const std::size_t first = slot({low[0], y, z}), last = first + length;
        scan(box, first, std::min(last, slots), visit);
        if (last > slots) scan(box, 0, last - slots, visit);
      }
  }

 private:
  using Cube = std::array<std::uint64_t, 3>;

  template <class Visit>
  void scan(const Box& box, std::size_t first, std::size_t last, Visit visit) const {
    for (Index i = start_[first]; i < start_[last]; ++i)
      if (contains(box, entries_[i].place)) visit(entries_[i]);
  }
  /// A place that is not finite, too, has a cube; the step finds it out and says so.
  Cube cube(const Vec3& p) const {
    constexpr double most = 1 << 30;
    Cube cube;
    for (std::size_t c = 0; c < 3; ++c) {
      const double at = (p[c] - origin_[c]) * per_cell_;
      cube[c] = at > 0 ? static_cast<std::uint64_t>(at < most ? at : most) : 0;
    }
    return cube;
  }
  std::size_t slot(const Cube& cube) const {
    const std::uint64_t row = cube[1] * 0x9E3779B97F4A7C15u + cube[2] * 0xC2B2AE3D27D4EB4Fu;
    return ((row >> 32) + cube[0]) & (start_.size() - 2);
  }

  double per_cell_;
  Vec3 origin_{};
  std::vector<Index> start_;  ///< by slot, of which there are a power of two
  std::vector<Entry> entries_;
};

}  // namespace suture
