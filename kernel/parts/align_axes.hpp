// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "kernel/base/types.hpp"

namespace suture {

/// Numbers the corners of hexahedra as those of the neighbour through which they are reached from
/// the first one of their body: along the same axes as it, if all could be parts of one grid
/// (lattice.hpp). Corners that are so already stay. O(n log n).
void align_axes(std::span<Hexahedron> elements);

}  // namespace suture
