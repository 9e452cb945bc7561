// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/mesh/mesh.hpp"

namespace suture {

struct BoxOptions {
  Vec3 origin{};       ///< m, the corner with the smallest coordinates
  Vec3 size{1, 1, 1};  ///< m
  std::array<Index, 3> cells{1, 1, 1};
  Vec3 grading{1, 1, 1};  ///< last cell / first cell along each axis
};

/// A regular grid; the x index runs fastest, for points and for hexahedra. With grading, the widths
/// of cells grow geometrically along an axis. The sides are the point sets "x0", "x1" (smallest and
/// largest x), "y0", ... The ends are exactly `origin` and `origin + size`; a box centred at the
/// origin is exactly mirror-symmetric, and grading 1/g is the mirror image of grading g. Throws
/// InputError if there are no cells, if size or grading are not positive and finite, if there are
/// more hexahedra than the map can number, or if cells are thinner than the rounding of a
/// coordinate. Cost: 0.02 us per hexahedron, 56 B.
Mesh make_box(const BoxOptions& options);

/// The same box relative to its own origin: exactly the points of the box at 0, and `origin` as
/// Mesh::origin. Throws the same errors as make_box().
Mesh make_local_box(const BoxOptions& options);

}  // namespace suture
