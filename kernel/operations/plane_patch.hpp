// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "kernel/operations/cut_area.hpp"
#include "kernel/operations/cut_faces.hpp"

namespace suture {

/// A plane, or the part of it that lies in a disc around `point` and inside a
/// polygon: flat blades, which need no tree of triangles.
struct PlanePatch {
  Vec3 point, normal;                                       ///< m; any length except 0
  double radius = std::numeric_limits<double>::infinity();  ///< m
  std::span<const Vec3> polygon{};                          ///< m, in the plane; empty: all of it
};

/// Whether a point of the plane is in the patch, or at most `reach` (m) away from it.
bool is_inside(const PlanePatch& patch, const Vec3& p, double reach = 0);

/// The faces whose two elements lie on different sides of the plane
/// (faces_across_plane(), also for shapes, order, errors), if the segment between
/// their centroids crosses it inside the patch:
///
///         . a          the segment a b meets the plane inside   -> its face is cut
///     ----x------|     c d beside it                            -> is not
///         . b    . c d
///
/// A crossing on the rim of the disc or on a side of the polygon is inside, and so is one that is
/// nearer to them than reach_in_edges of the shortest edge of the face. O(elements); with `blocks`,
/// of the vertices where they are, only those near the patch. `area`: of the cut faces and of the
/// patch, as those across the plane project onto it; not measured for a whole plane.
std::vector<Dart> faces_across_patch(const CellComplex& complex, const double* rows,
                                     const PlanePatch& patch, std::size_t stride = 4,
                                     const ElementBlocks* blocks = nullptr,
                                     CutArea* area = nullptr);

}  // namespace suture
