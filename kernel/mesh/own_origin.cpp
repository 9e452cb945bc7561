// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/mesh/own_origin.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace suture {

Extent extent_of(const Mesh& mesh) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Extent box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (const Hexahedron& nodes : mesh.hexahedra) {
    for (const Index node : nodes) {
      if (node >= mesh.points.size()) continue;  // refused by the import
      for (std::size_t a = 0; a < 3; ++a) {
        box.low[a] = std::min(box.low[a], mesh.points[node][a]);
        box.high[a] = std::max(box.high[a], mesh.points[node][a]);
      }
    }
  }
  for (std::size_t a = 0; a < 3; ++a)
    if (!std::isfinite(box.low[a]) || !std::isfinite(box.high[a])) return {};
  return box;
}

void move_to_own_origin(Mesh& mesh) {
  const Vec3 low = extent_of(mesh).low;
  if (low == Vec3{}) return;
  for (Vec3& point : mesh.points)
    for (std::size_t a = 0; a < 3; ++a) point[a] -= low[a];
  for (std::size_t a = 0; a < 3; ++a) mesh.origin[a] += low[a];
}

}  // namespace suture
