// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/mesh/parts.hpp"
#include "kernel/topology/cell_complex.hpp"

// A blade is a plane in each of the six Kuhn tetrahedra of an element. So a series of cuts leaves
// of each such tetrahedron one convex cell. Clipping makes more and more tetrahedra of it, which
// are not geometry, but history:
//
//      +-------+-------+            +---------------+
//      |\     /|\     /|            |\              |      Each cell is described by its faces
//      | \   / | \   / |            |    \          |      alone, without points in the middle of
//      |  \ /  |  \ /  |   ---->    |        \      |      edges, edges in the middle of faces,
//      |   +---+---+   |            |            \  |      and faces in the middle of a cell.
//      +--/-----------\+            +---------------+
//
// What is a corner, an edge or a face of any cell around stays in all of them: both sides of every
// face keep the same triangles.

namespace suture {

/// The most tetrahedra of a part that are left as clipping has made them: a cut through a whole
/// element makes up to 18 for each part. A part that has more is described anew after each cut.
inline constexpr std::size_t many_tetrahedra = 64;

/// Where the elements of a complex lie in the mesh.
struct LatticePlaces {
  std::span<const Hexahedron> corners;    ///< vertices of the elements before all operations
  std::span<const Index> origin_of_copy;  ///< the elements of which later ones are copies

  Index element(Index e) const {
    return e < corners.size() ? e : origin_of_copy[e - corners.size()];
  }
  const Hexahedron& of(Index e) const { return corners[element(e)]; }
};

/// Describes the materials of existing `elements`, and of those that share corners with them, by as
/// few cells, and these by as few tetrahedra, as their geometry needs. Cells of one element and one
/// Kuhn tetrahedron whose union is convex become one: so an element whose parts were sewn loses the
/// planes between them, and one that is whole again has its six tetrahedra, if those around it
/// allow it; then it is no longer listed. What no longer exists is dropped.
///
/// Volumes, moments and the surface keep their places; `cut_of_triangle`, by triangle of the parts,
/// follows. A cell is left as it is where rounding would turn a tetrahedron inside out.
/// O(elements of the complex), and 5 us per tetrahedron around `elements`.
void coarsen_parts(Parts& parts, std::vector<Index>& cut_of_triangle, const CellComplex& complex,
                   const LatticePlaces& places, std::span<const Index> elements);

}  // namespace suture
