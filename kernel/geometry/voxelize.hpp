// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/diagnostics.hpp"
#include "kernel/geometry/surface.hpp"
#include "kernel/mesh/mesh.hpp"

namespace suture {

struct VoxelizeOptions {
  std::size_t cells = 0;        ///< about as many hexahedra; 0: `edge` decides
  double edge = 0;              ///< m, of a cube; 0: `cells` decides
  bool largest_island = false;  ///< keep only the cubes that hang together by faces
};

/// Fills a closed, outward surface (surface_file.hpp: close_surface) with equal cubes
/// along the axes: those whose centre lies inside, decided exactly. The lattice is
/// centred on the surface's bounding box. With `cells`, the edge starts from
/// cbrt(volume / cells) and is corrected by counting, up to 16 times, until the number is
/// within 1 % (the best is kept, a warning tells if it is further away).
/// Cubes run along x, then y, then z. Pinched vertices (cubes that meet along an edge
/// or at a corner only) are split as the import does it, with a warning that counts them.
/// Cubes of less than half or more than twice the volume enclosed get a warning,
/// unless only the largest island is kept.
/// Throws InputError: neither or both of cells and edge, more cubes than links can number, no
/// cube inside (says the size of the body); with `cells`, more than 10,000 cubes of the bounding
/// box for each that is wanted, and more than a million (says how far the surface reaches).
/// Cost: 0.2 us per triangle and 60 ns per cube of the bounding box, for each count.
Mesh voxelize(const TriangleSurface& surface, const VoxelizeOptions& options,
              Diagnostics& diagnostics);

}  // namespace suture
