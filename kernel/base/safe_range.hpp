// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "kernel/base/types.hpp"

namespace suture {

// Lengths that the program can compute with, m. Cross products square them, volumes cube them and
// norms of these square the result: the sixth power of a length in this range, also of one that is
// divided into 10^8 cells, neither overflows nor underflows. Readers check what they read.
inline constexpr double shortest_length = 1e-30, longest_length = 1e30;

/// Whether x can be a coordinate or a displacement; false if it is not finite.
inline bool is_safe_coordinate(double x) { return std::abs(x) <= longest_length; }
inline bool is_safe_point(const Vec3& p) { return std::ranges::all_of(p, is_safe_coordinate); }

/// Whether x can be a radius, a size, or a distance between different points.
inline bool is_safe_length(double x) { return x >= shortest_length && x <= longest_length; }

/// Whether a can be a direction, which has no unit but a length that is squared.
inline bool is_safe_direction(const Vec3& a) {
  return is_safe_length(std::max({std::abs(a[0]), std::abs(a[1]), std::abs(a[2])}));
}

}  // namespace suture
