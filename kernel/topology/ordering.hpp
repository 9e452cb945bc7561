// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/base/types.hpp"

namespace suture {

/// True if a walk over the elements in order returns to vertices while they are still in the cache:
/// on average at most two returns per vertex after more than 512 other elements (first-level
/// cache), and at most one vertex in three with a return after more than 16,384 (half of a 2 MB
/// second-level cache with positions and forces). Grids with layers of up to 16,384 cells pass,
/// whose order also suits the prefetcher, as does the output of most meshers. O(elements).
bool is_local(std::span<const Hexahedron> hexahedra, Index point_count);

/// Orders elements along a space-filling curve (Morton) through their centroids: result[i] is the
/// position in `hexahedra` of the i-th element. `used`: the points that the elements use, which
/// must be finite. O(elements).
std::vector<Index> curve_order(std::span<const Hexahedron> hexahedra, std::span<const Vec3> points,
                               const std::vector<bool>& used);

/// The order in which the import numbers elements: along the curve, or empty if the given order is
/// local.
std::vector<Index> local_order(std::span<const Hexahedron> hexahedra, std::span<const Vec3> points,
                               const std::vector<bool>& used);

}  // namespace suture
