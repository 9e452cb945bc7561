// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/attributes/column.hpp"
#include "kernel/base/parallel.hpp"
#include "kernel/results/piece_cells.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// Recovers a stress that is known at the centres of elements at the vertices: a linear function of
/// the position is fitted by least squares to the elements around the vertex, and evaluated there.
///
///     +---+---+          o: the vertex, x: the centres of its elements. Where these leave the
///     | x | x |          slope in some direction undetermined, as on the surface of the body,
///     +---o---+          the elements behind the faces of x take part as well.
///     | x | x |
///     +---+---+
///
/// A linear stress is recovered exactly, also on the surface. A slope that remains undetermined, as
/// across a layer of one element, is zero. Both sides of a cut have their own vertices, and no
/// neighbours beyond it. O. C. Zienkiewicz, J. Z. Zhu, The superconvergent patch recovery and a
/// posteriori error estimates, Int. J. Numer. Methods Eng. 33 (1992) 1331; here with a patch of
/// its own for each vertex.
///
/// `stress`: 6 components per element. `group`: per element; only elements of one group are fitted
/// together, at a vertex of several groups those of the smallest; `none`: the element has no
/// stress. Read at elements around `vertices` and behind their faces. Returns 6 components for each
/// of these, NaN where there is no stress. O(vertices).
std::vector<double> nodal_stress(const CellComplex& complex, const Column& position,
                                 std::span<const double> stress, std::span<const Index> group,
                                 const Workers& workers, const ShownCells& vertices);

}  // namespace suture
