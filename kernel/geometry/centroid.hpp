// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "kernel/base/types.hpp"

namespace suture {

/// Mean of the corners, m: the position of an element for events. Vertex v is at rows[stride * v].
inline Vec3 centroid(const Hexahedron& nodes, const double* rows, std::size_t stride) {
  Vec3 sum{};
  for (const Index v : nodes)
    for (std::size_t c = 0; c < 3; ++c) sum[c] += rows[stride * v + c] / 8;
  return sum;
}

}  // namespace suture
