// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <limits>

#include "kernel/base/vec3.hpp"

namespace suture {

/// A box parallel to the axes.
struct Box {
  Vec3 low{}, high{};
  double length(std::size_t axis) const { return high[axis] - low[axis]; }
};

/// The empty box: low > high.
inline constexpr Box no_box = [] {
  constexpr double far = std::numeric_limits<double>::infinity();
  return Box{{far, far, far}, {-far, -far, -far}};
}();

/// The box that holds all places.
inline constexpr Box everywhere{no_box.high, no_box.low};

inline void include(Box& box, const Vec3& p) {
  for (std::size_t a = 0; a < 3; ++a) {
    box.low[a] = std::min(box.low[a], p[a]);
    box.high[a] = std::max(box.high[a], p[a]);
  }
}

inline void include_box(Box& box, const Box& other) {
  for (std::size_t a = 0; a < 3; ++a) {
    box.low[a] = std::min(box.low[a], other.low[a]);
    box.high[a] = std::max(box.high[a], other.high[a]);
  }
}

/// 0 of an empty one.
inline double diagonal_of(const Box& box) {
  return box.low[0] > box.high[0] ? 0 : norm(minus(box.high, box.low));
}

/// Whether a point is in the box, or at most `margin` beside it.
inline bool contains(const Box& box, const Vec3& p, double margin = 0) {
  for (std::size_t a = 0; a < 3; ++a)
    if (p[a] < box.low[a] - margin || p[a] > box.high[a] + margin) return false;
  return true;
}

/// Whether they have a point in common.
inline bool overlap(const Box& a, const Box& b) {
  return a.low[0] <= b.high[0] && b.low[0] <= a.high[0] && a.low[1] <= b.high[1] &&
         b.low[1] <= a.high[1] && a.low[2] <= b.high[2] && b.low[2] <= a.high[2];
}

}  // namespace suture
