// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "kernel/mesh/mesh.hpp"

namespace suture {

/// A shape drawn with characters, one per cube; z runs through the layers.
struct VoxelOptions {
  Vec3 origin{};                  ///< m, the corner of the drawing with the smallest coordinates
  double size = 1;                ///< m, edge length of a cube
  Index layers = 1;               ///< identical layers of cubes along z
  std::vector<std::string> rows;  ///< top (largest y) first; '.' and ' ' are empty
};

/// One cube per non-empty character and layer. Every character except '#' defines an element set
/// and a point set of that name; the outer sides are the point sets "x0", "x1", ... as in a box.
/// Elements are numbered along x, then upwards, then through the layers. Throws InputError if there
/// is no cube or no layer, or if size is not positive. Linear in the size of the drawing.
Mesh make_voxels(const VoxelOptions& options);

/// The same mesh relative to its own origin: exactly the points of the drawing at 0, and `origin`
/// as Mesh::origin.
Mesh make_local_voxels(const VoxelOptions& options);

}  // namespace suture
