// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/parts/fill_surface.hpp"

namespace suture {

/// Fills a body whose shape and materials are those of solid cells of any kind, such as
/// tetrahedra: fill_surface() with the boundary of the cells (read_shape()) as the surface.
///
/// - Sets of elements: an element belongs to the sets of the material of which it holds most.
///   Materials are cells that belong to the same sets, so regions that divide the shape divide the
///   elements, too. A note gives the number of elements that hold several.
/// - Arrays of elements: the mean over the cells in the element, by volume; NaN if none of them has
///   a value. Arrays of points are not carried over.
/// - Sets of points: those with faces of the boundary stand for these faces, and become the nodes
///   outside the material of elements that touch them (as selections by place take them). Others
///   become the nodes of the elements that hold their points.
///
/// Cells are clipped exactly by the cubes; overlapping cells count twice. Throws InputError as
/// close_surface() and fill_surface() do. Cost besides those: 0.5 us per face of the cells, and 0.3
/// us for each cell and cube that meet.
Mesh fill_shape(const Mesh& shape, const CubeSize& size, bool repair, Diagnostics& diagnostics,
                const std::string& repair_option = "--repair");

}  // namespace suture
