// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/place_grid.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "kernel/contact/row_lanes.hpp"
#include "kernel/solvers/clones.hpp"

namespace suture {
namespace {

constexpr std::size_t eight = 8;
constexpr double nowhere = std::numeric_limits<double>::infinity();
typedef double Eight __attribute__((vector_size(64), aligned(8), may_alias));

/// What a scan reads, by entry.
struct Columns {
  const double *x, *y, *z, *pieces;
  const Index* items;
};

/// The least distance from two sides of a box; negative outside.
SUTURE_INLINE Eight depth(const Eight& places, double low, double high) {
  const Eight from_low = places - low, from_high = high - places;
  return from_low < from_high ? from_low : from_high;
}
SUTURE_INLINE Eight least(const Eight& a, const Eight& b) { return a < b ? a : b; }

/// Writes the items in the box that are not of a piece; returns the end of what it wrote. What is
/// behind the last entry of an eight is tested, too.
SUTURE_CLONES
Index* find_in(const Columns& columns, std::size_t first, std::size_t last, const Box& box,
               double except, Index* found) {
  const auto at = [](const double* p) __attribute__((always_inline)) {
    return *reinterpret_cast<const Eight*>(p);
  };
  for (std::size_t i = first; i < last; i += eight) {
    const Eight inside = least(least(depth(at(columns.x + i), box.low[0], box.high[0]),
                                     depth(at(columns.y + i), box.low[1], box.high[1])),
                               depth(at(columns.z + i), box.low[2], box.high[2]));
    const Eight result = at(columns.pieces + i) == except ? Eight{} - 1.0 : inside;
    for (std::size_t l = 0; l < eight; ++l) {
      *found = columns.items[i + l];
      found += result[l] >= 0;
    }
  }
  return found;
}

}  // namespace

/// Sorted by counting.
PlaceGrid::PlaceGrid(std::span<const Entry> entries, double cell, double before)
    : per_cell_(1 / cell), start_(std::bit_ceil(entries.size() + 1) + 1) {
  Box box = no_box;
  for (const Entry& entry : entries) include(box, entry.place);
  for (std::size_t c = 0; c < 3; ++c) origin_[c] = box.low[c] - before;
  std::vector<Index> slots(entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    slots[i] = static_cast<Index>(slot(cube(entries[i].place)));
    ++start_[slots[i] + 1];
  }
  for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
  std::vector<Index> next(start_.begin(), start_.end() - 1);
  for (auto& coordinates : places_) coordinates.assign(entries.size() + eight, nowhere);
  items_.resize(entries.size() + eight);
  pieces_.resize(entries.size() + eight);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const Index to = next[slots[i]]++;
    for (std::size_t c = 0; c < 3; ++c) places_[c][to] = entries[i].place[c];
    items_[to] = entries[i].item;
    pieces_[to] = entries[i].piece;
  }
}

std::span<const Index> PlaceGrid::find(const Box& box, Index except) {
  count_ = 0;
  const Cube low = cube(box.low), high = cube(box.high);
  const std::uint64_t length = high[0] - low[0] + 1, slots = start_.size() - 1;
  const std::uint64_t rows = (high[1] - low[1] + 1) * (high[2] - low[2] + 1);
  if (length >= slots || rows > slots) {
    scan(box, except, 0, slots);
    return std::span(found_).first(count_);
  }
  for (std::uint64_t z = low[2]; z <= high[2]; ++z)
    for (std::uint64_t y = low[1]; y <= high[1]; ++y) {
      const std::size_t first = slot({low[0], y, z}), last = first + length;
      scan(box, except, first, std::min(last, slots));
      if (last > slots) scan(box, except, 0, last - slots);
    }
  return std::span(found_).first(count_);
}

/// The entries of slots, and a few behind them.
void PlaceGrid::scan(const Box& box, Index except, std::size_t first, std::size_t last) {
  const std::size_t begin = start_[first], end = start_[last];
  if (begin == end) return;
  if (found_.size() < count_ + (end - begin) + eight)
    found_.resize(2 * count_ + end - begin + eight);
  const Columns columns{places_[0].data(), places_[1].data(), places_[2].data(), pieces_.data(),
                        items_.data()};
  Index* const found = found_.data() + count_;
  count_ += static_cast<std::size_t>(find_in(columns, begin, end, box, except, found) - found);
}

/// A place that is not finite, too, has a cube; the step finds it out and says so.
PlaceGrid::Cube PlaceGrid::cube(const Vec3& p) const {
  constexpr double most = 1 << 30;
  Cube cube;
  for (std::size_t c = 0; c < 3; ++c) {
    const double at = (p[c] - origin_[c]) * per_cell_;
    cube[c] = at > 0 ? static_cast<std::uint64_t>(at < most ? at : most) : 0;
  }
  return cube;
}

std::size_t PlaceGrid::slot(const Cube& cube) const {
  const std::uint64_t row = cube[1] * 0x9E3779B97F4A7C15u + cube[2] * 0xC2B2AE3D27D4EB4Fu;
  return ((row >> 32) + cube[0]) & (start_.size() - 2);
}

}  // namespace suture
