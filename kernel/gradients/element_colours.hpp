// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/attributes/table.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// The rows of a set of elements, in groups of elements that share no vertex. Some 8 on a grid.
/// O(elements).
std::vector<std::vector<Index>> colour_elements(const CellComplex& complex,
                                                const CellSet& elements);

/// The vertices of a set of elements, in groups of which each element has at most one. Some 8 on a
/// grid. O(elements).
std::vector<std::vector<Index>> colour_vertices(const CellComplex& complex,
                                                const CellSet& elements);

/// The vertices of the elements around each vertex, ascending.
std::vector<std::vector<Index>> stars_of(const CellComplex& complex);
/// Vertices in groups whose stars have no vertex in common. Some 27 on a grid. O(elements).
std::vector<std::vector<Index>> colour_stars(const std::vector<std::vector<Index>>& stars);

}  // namespace suture
