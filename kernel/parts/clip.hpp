// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "kernel/base/box.hpp"

namespace suture {

/// The volume of a tetrahedron of either orientation inside a box. 0.1 to 1 us.
double volume_within(const std::array<Vec3, 4>& tetrahedron, const Box& box);

/// The six tetrahedra of cut_pattern(all_corners) in a cell of corners X0..X7.
std::array<std::array<Vec3, 4>, 6> tetrahedra_of(const std::array<Vec3, 8>& corners);

/// Whether a convex polygon meets a box.
bool meets(std::vector<Vec3> polygon, const Box& box);

}  // namespace suture
