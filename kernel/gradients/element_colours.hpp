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

}  // namespace suture
