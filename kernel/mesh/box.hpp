// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/mesh/mesh.hpp"

namespace suture {

struct BoxOptions {
  Vec3 origin{};       ///< m, corner of smallest coordinates
  Vec3 size{1, 1, 1};  ///< m
  std::array<Index, 3> cells{1, 1, 1};
  Vec3 grading{1, 1, 1};  ///< last cell / first cell along each axis
};

/// Regular grid, x index fastest, for points and for hexahedra. Widths of cells
/// grow geometrically along an axis with grading. Point sets "x0", "x1" (smallest
/// and largest x), "y0", ... of the sides. The ends are `origin` and `origin + size`
/// to the bit; a box centred at the origin is mirror-symmetric to the bit, and
/// grading 1/g is the mirror image of grading g.
/// Throws InputError: no cells, size or grading not positive or not finite, more
/// hexahedra than darts can number, cells thinner than the rounding of a coordinate.
/// Cost: 0.02 us per hexahedron, 56 B.
Mesh make_box(const BoxOptions& options);

/// The same about its own origin: the points of the box at 0, to the bit, and `origin` as
/// Mesh::origin. Throws what make_box() throws.
Mesh make_local_box(const BoxOptions& options);

}  // namespace suture
