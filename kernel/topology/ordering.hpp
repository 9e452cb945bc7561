// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/base/types.hpp"

namespace suture {

/// True if walking the elements in their order finds vertices again while they are
/// still in the cache: per vertex at most two returns after more than 512 other
/// elements (first-level cache), and at most one in three vertices with a return after
/// more than 16,384 (half of a 2 MB second-level cache with positions and forces).
/// Grids with layers of up to 16,384 cells pass, whose order also suits the
/// prefetcher, and most meshers' output. O(elements).
bool is_local(std::span<const Hexahedron> hexahedra, Index point_count);

/// Elements along a space-filling curve (Morton) through their centroids:
/// result[i] is the position in `hexahedra` of the i-th. `used`: the points that the
/// elements name, which must be finite. O(elements).
std::vector<Index> curve_order(std::span<const Hexahedron> hexahedra, std::span<const Vec3> points,
                               const std::vector<bool>& used);

/// The order in which the import numbers elements: along the curve, or nothing if
/// theirs is local.
std::vector<Index> local_order(std::span<const Hexahedron> hexahedra, std::span<const Vec3> points,
                               const std::vector<bool>& used);

}  // namespace suture
