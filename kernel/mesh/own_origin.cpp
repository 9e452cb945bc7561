// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/mesh/own_origin.hpp"

#include <algorithm>
#include <cmath>

namespace suture {

Box box_of(const Mesh& mesh) {
  Box box = no_box;
  for (const Hexahedron& nodes : mesh.hexahedra) {
    for (const Index node : nodes)
      if (node < mesh.points.size()) include(box, mesh.points[node]);  // others: import refuses
  }
  for (std::size_t a = 0; a < 3; ++a)
    if (!std::isfinite(box.low[a]) || !std::isfinite(box.high[a])) return {};
  return box;
}

void move_to_own_origin(Mesh& mesh) {
  const Vec3 low = box_of(mesh).low;
  if (low == Vec3{}) return;
  for (Vec3& point : mesh.points)
    for (std::size_t a = 0; a < 3; ++a) point[a] -= low[a];
  for (std::size_t a = 0; a < 3; ++a) mesh.origin[a] += low[a];
}

}  // namespace suture
