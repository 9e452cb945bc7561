// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/diagnostics.hpp"
#include "kernel/geometry/surface.hpp"
#include "kernel/mesh/mesh.hpp"

namespace suture {

struct VoxelizeOptions {
  std::size_t cells = 0;        ///< approximate number of hexahedra; 0: given by `edge`
  double edge = 0;              ///< m, edge of a cube; 0: given by `cells`
  bool largest_island = false;  ///< keep only the largest set of cubes connected by faces
};

/// Fills a closed, outward-oriented surface (surface_file.hpp: close_surface) with equal,
/// axis-aligned cubes: those whose centre lies inside, decided exactly. The lattice is centred on
/// the surface's bounding box. With `cells`, the edge starts from cbrt(volume / cells) and is
/// corrected by counting, up to 16 times, until the number is within 1 % (the best result is kept;
/// a warning is issued if it is further off). Cubes are numbered along x, then y, then z.
/// Non-manifold vertices (where cubes meet only along an edge or at a corner) are split as in the
/// import, with a warning that gives their number. A warning is issued if the total volume of the
/// cubes is less than half or more than twice the enclosed volume, unless only the largest island
/// is kept. Throws InputError if neither or both of cells and edge are given, if there are more
/// cubes than links can number, or if no cube lies inside (gives the size of the body); with
/// `cells`, also if the bounding box has more than a million cubes and more than 10,000 for each
/// cube requested (gives the extent of the surface). Cost: 0.2 us per triangle and 60 ns per cube
/// of the bounding box, for each count.
Mesh voxelize(const TriangleSurface& surface, const VoxelizeOptions& options,
              Diagnostics& diagnostics);

}  // namespace suture
