// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/mesh/readers.hpp"
#include "kernel/mesh/vtk_grid.hpp"

namespace suture {

/// Hexahedra and voxels of the grid, other cells counted; label arrays as sets,
/// global ids as ids. Cells of 8 nodes that call themselves tetrahedra are meant to be
/// hexahedra (hex_sphere.vtk of planarhexmeshes) and read so, with a warning. Checks sizes, indices
/// and coordinates; throws InputError naming the cell or point.
Mesh mesh_from_vtk(VtkGrid grid, const FileText& file, Diagnostics& diagnostics);

}  // namespace suture
