// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "kernel/mesh/mesh.hpp"

namespace suture {

/// A shape drawn with characters, one per cube; z runs through the layers.
struct VoxelOptions {
  Vec3 origin{};                  ///< m, corner of smallest coordinates of the drawing
  double size = 1;                ///< m, edge of one cube
  Index layers = 1;               ///< cubes along z, all alike
  std::vector<std::string> rows;  ///< top (largest y) first; '.' and ' ' are empty
};

/// One cube per character and layer that is not empty. Every character but '#'
/// makes an element set and a point set of its name, and the outer sides the
/// point sets "x0", "x1", ... of a box. Elements run along x, then up, then
/// through the layers. Throws InputError if there is no cube, no layer or size
/// is not positive. Linear in the size of the drawing.
Mesh make_voxels(const VoxelOptions& options);

/// The same about its own origin: the points of the drawing at 0, to the bit, and `origin`
/// as Mesh::origin.
Mesh make_local_voxels(const VoxelOptions& options);

}  // namespace suture
