// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/diagnostics.hpp"
#include "kernel/geometry/surface.hpp"
#include "kernel/mesh/mesh.hpp"

namespace suture {

/// The size of the cubes that fill a surface: exactly one of the two.
struct CubeSize {
  std::size_t cells = 0;  ///< approximate number of hexahedra
  double edge = 0;        ///< m
};

/// Fills a closed, outward-oriented surface (surface_file.hpp: close_surface) with equal,
/// axis-aligned cubes, of which those that the surface crosses hold only the part inside it: the
/// boundary of the mesh, Mesh::parts, is the surface. It is exact at the crossings of the edges of
/// the cubes and of the six tetrahedra in each (cut_patterns.hpp), and flat between; volumes thus
/// converge with order 2. A crossing nearer to a corner than 0.02 edges is moved to that distance,
/// against slivers. What holds no corner of a cube is not seen: walls and gaps that are thinner
/// than an edge.
///
/// Connected parts of a cube become hexahedra of their own (pieces.hpp). The lattice is centred on
/// the surface's bounding box and at least 0.05 edges larger on each side. With `cells`, the edge
/// is found by counting (cube_size.hpp). Elements are numbered along x, then y, then z.
///
/// Warns if the enclosed volume differs by more than a tenth from that of the surface. Throws
/// InputError as voxelize() does. Cost: 0.2 us per triangle and 60 ns per cube of the bounding box
/// for each count; then 3 us per element that the surface crosses, for triangles of the size of
/// cubes.
Mesh fill_surface(const TriangleSurface& surface, const CubeSize& size, Diagnostics& diagnostics);

}  // namespace suture
