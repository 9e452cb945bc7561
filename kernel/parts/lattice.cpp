// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/lattice.hpp"

#include "kernel/parts/cube_sides.hpp"

namespace suture {

Index first_off_lattice(const CellComplex& complex) {
  for (Index e = 0; e < complex.element_count(); ++e) {
    if (!complex.exists(3, e)) continue;
    const Hexahedron& nodes = complex.vertices_of(e);
    for (const CubeSide side : cube_sides) {
      const Index n = complex.neighbour(e, side.face());
      if (n == none) continue;
      const unsigned across = 1u << side.axis;
      for (unsigned i = 0; i < hexahedron::vertices; ++i)
        if (((i & across) != 0) == side.is_upper && nodes[i] != complex.vertices_of(n)[i ^ across])
          return e;
    }
  }
  return none;
}

}  // namespace suture
