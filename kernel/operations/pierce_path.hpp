// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/geometry/element_blocks.hpp"

namespace suture {

/// The elements whose centroid lies within `radius` (m) of the polyline through `path` (at least
/// one point), ascending; may be empty. Vertex v is at rows[stride * v], deformed or at rest.
/// O(elements + elements near the path x segments), about 10 ns per element; with `blocks`, of the
/// vertices where they are, only those near the path.
std::vector<Index> elements_along_path(const CellComplex& complex, const double* rows,
                                       std::span<const Vec3> path, double radius,
                                       std::size_t stride = 4,
                                       const ElementBlocks* blocks = nullptr);

}  // namespace suture
