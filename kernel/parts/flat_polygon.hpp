// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/geometry/surface.hpp"

namespace suture {

/// Divides a polygon in a plane, whose corners are at these places, into triangles with its
/// orientation and no corners but its own; empty if there are none that are not degenerate. Corners
/// may lie between others in a line. From its lowest corner, if possible, so that cones of cells
/// whose lowest corner is the same fit.
std::vector<Triangle> triangulated(const std::vector<Index>& polygon, const std::vector<Vec3>& at);

}  // namespace suture
