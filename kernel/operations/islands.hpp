// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/scene/event.hpp"
#include "kernel/topology/islands.hpp"

namespace suture {

/// The elements of the islands to remove: those with fewer than `below` elements, or without a
/// vertex inside the box, where vertex v is at rows[stride * v] (m). Ascending; may be empty or
/// contain all elements. O(elements).
std::vector<Index> elements_of_islands(const CellComplex& complex, const Islands& islands,
                                       const double* rows, const RemoveIslands& which,
                                       std::size_t stride = 4);

}  // namespace suture
