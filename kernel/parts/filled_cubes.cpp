// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/filled_cubes.hpp"

#include <cmath>

namespace suture {

FilledCubes::FilledCubes(const Mesh& mesh) : mesh_(mesh) {
  edge_ = box_of(0).length(0);
  for (std::size_t e = 0; e < mesh.hexahedra.size(); ++e) include(around_, box_of(e).low);
  for (std::size_t e = 0; e < mesh.hexahedra.size(); ++e)
    keys_.push_back(key(number_of(box_of(e).low)));
}

FilledCubes::Numbers FilledCubes::number_of(const Vec3& low_corner) const {
  Numbers n;
  for (std::size_t a = 0; a < 3; ++a)
    n[a] = static_cast<std::uint64_t>(std::llround((low_corner[a] - around_.low[a]) / edge_));
  return n;
}

FilledCubes::Numbers FilledCubes::clamped(const Vec3& place) const {
  Numbers n;
  for (std::size_t a = 0; a < 3; ++a) {
    const double last = std::round(around_.length(a) / edge_);
    n[a] = static_cast<std::uint64_t>(
        std::clamp(std::floor((place[a] - around_.low[a]) / edge_), 0.0, last));
  }
  return n;
}

}  // namespace suture
