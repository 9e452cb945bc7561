// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// Elements with a corner Jacobian <= 0 at the current positions, ascending. O(elements), much
/// cheaper than an evaluation of forces.
std::vector<Index> find_inverted(const CellComplex& complex, Attributes& attributes);

}  // namespace suture
