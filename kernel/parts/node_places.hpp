// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/mesh/parts.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// Where the nodes of a body with partial elements are, for selections by place. Those outside the
/// material stand for the places where the surface crosses the edges from them.
struct NodePlaces {
  struct Crossing {
    Index vertex;  ///< the outer end of the edge
    EmbeddedPoint place;
  };
  std::vector<std::uint8_t> is_inside;  ///< by vertex: in the material
  std::vector<Crossing> crossings;
};

/// Finds the places of the nodes of existing elements, as the complex is now. O(elements + points).
NodePlaces node_places(const Parts& parts, const CellComplex& complex);

}  // namespace suture
