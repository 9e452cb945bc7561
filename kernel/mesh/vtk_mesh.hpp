// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/mesh/readers.hpp"
#include "kernel/mesh/vtk_grid.hpp"

namespace suture {

/// Converts hexahedra and voxels of the grid, with `all_solids` also tetrahedra, pyramids and
/// wedges (read_shape()), and counts other cells; label arrays become sets,
/// global ids become ids, and arrays keep the values of the cells that are kept. Cells with 8 nodes
/// that are declared as tetrahedra are read as hexahedra, with a warning (hex_sphere.vtk of
/// planarhexmeshes). Checks sizes, indices and coordinates; throws InputError naming the cell or
/// point.
Mesh mesh_from_vtk(VtkGrid grid, const FileText& file, bool all_solids, Diagnostics& diagnostics);

}  // namespace suture
