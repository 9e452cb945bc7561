// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "kernel/base/vec3.hpp"

namespace suture {

/// How a load on a surface varies with the place X at rest: by a factor of s = X . along, linear
/// between the points (s, factor), and constant beyond the first and the last one. Without points,
/// the factor is 1. A hydrostatic pressure has two points.
struct LoadProfile {
  Vec3 along{0, 0, 1};                        ///< a unit vector
  std::vector<std::array<double, 2>> points;  ///< s in m, ascending, and the factor

  double operator()(const Vec3& X) const {
    if (points.empty()) return 1;
    const double s = dot(X, along);
    const auto above =
        std::ranges::upper_bound(points, s, {}, [](const auto& point) { return point[0]; });
    if (above == points.begin()) return points.front()[1];
    if (above == points.end()) return points.back()[1];
    const auto& [s0, f0] = *(above - 1);
    const auto& [s1, f1] = *above;
    return f0 + (f1 - f0) * (s - s0) / (s1 - s0);
  }
};

}  // namespace suture
