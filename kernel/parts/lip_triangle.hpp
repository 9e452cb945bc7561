// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>

#include "kernel/base/vec3.hpp"

namespace suture {

/// A triangle of a lip in the reference cube of an element.
struct LipTriangle {
  std::array<Vec3, 3> x;
  Vec3 area, centroid;  ///< twice the area vector

  explicit LipTriangle(const std::array<Vec3, 3>& corners)
      : x(corners),
        area(cross(minus(x[1], x[0]), minus(x[2], x[0]))),
        centroid(scaled(1.0 / 3, plus(x[0], plus(x[1], x[2])))) {}

  /// Whether it lies in the plane of the other one and contains its centroid.
  bool covers(const LipTriangle& other) const {
    constexpr double tolerance = 1e-9;
    const double size = norm(area);
    if (std::abs(dot(area, other.area)) < (1 - tolerance) * size * norm(other.area)) return false;
    if (std::abs(dot(area, minus(other.centroid, x[0]))) > tolerance * size) return false;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 &from = x[i], &to = x[(i + 1) % 3];
      if (dot(area, cross(minus(to, from), minus(other.centroid, from))) < 0) return false;
    }
    return true;
  }
  bool faces(const LipTriangle& other) const { return dot(area, other.area) < 0; }
};

}  // namespace suture
