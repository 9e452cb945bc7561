// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// The connected piece (island) that each of the first `vertices` vertices belongs to,
/// numbered from the largest (in vertices); `none` for vertices without an element.
/// O(elements).
std::vector<Index> pieces_of(const CellComplex& complex, Index vertices);

}  // namespace suture
