// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "kernel/geometry/shape.hpp"

namespace suture {

/// The surface of a shape for display.
struct ShapeMesh {
  std::vector<Vec3> points;
  std::vector<std::array<Index, 4>> faces;  ///< the last index is none for triangles
};

/// `around`, `size`: the part of a half-space that is shown, a square around the point of its plane
/// nearest to `around`, m.
ShapeMesh mesh_of(const Shape& shape, const Vec3& around, double size);

}  // namespace suture
