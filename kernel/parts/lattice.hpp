// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// The first element whose corners are not numbered as those of a neighbour, so that the six
/// tetrahedra in both would not meet; none if the elements are numbered as those of a grid.
/// O(elements).
Index first_off_lattice(const CellComplex& complex);

}  // namespace suture
