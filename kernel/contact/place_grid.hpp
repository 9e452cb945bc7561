// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernel/base/box.hpp"

namespace suture {

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
/// after the other and tested eight at a time; those of other cubes among them are found to be
/// outside the box.
class PlaceGrid {
 public:
  struct Entry {
    Vec3 place;
    Index item, piece;
  };

  /// `cell`: the edge of a cube. Boxes do not begin farther than `before` below all entries.
  PlaceGrid(std::span<const Entry> entries, double cell, double before);

  /// The items in a box that are not of the piece `except` (or `none`), some more than once; valid
  /// until the next call.
  std::span<const Index> find(const Box& box, Index except);

 private:
  using Cube = std::array<std::uint64_t, 3>;

  Cube cube(const Vec3& p) const;
  std::size_t slot(const Cube& cube) const;
  void scan(const Box& box, Index except, std::size_t first, std::size_t last);

  double per_cell_;
  Vec3 origin_{};
  std::vector<Index> start_;  ///< by slot, of which there are a power of two
  // By entry, and some that are nowhere.
  std::array<std::vector<double>, 3> places_;
  std::vector<double> pieces_;
  std::vector<Index> items_;
  std::vector<Index> found_;
  std::size_t count_ = 0;  ///< of found_
};

}  // namespace suture
