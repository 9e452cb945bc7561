// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "kernel/base/types.hpp"

namespace suture {

/// A tetrahedron, pyramid, wedge or hexahedron, by its 4, 5, 6 or 8 corners in the order of VTK,
/// Gmsh and Medit, as a hexahedron X0..X7 of which nodes coincide:
///
///     X6---X7        tetrahedron a b c d: X0 = a, X1 = b, X2 = X3 = c, X4 .. X7 = d
///    /|   /|         pyramid a b c d e:   X0 = a, X1 = b, X3 = c, X2 = d, X4 .. X7 = e
///   X4---X5|         wedge a b c, d e f:  X0 = a, X1 = b, X2 = X3 = c,
///   | X2-|-X3                             X4 = d, X5 = e, X6 = X7 = f
///   |/   |/
///   X0---X1
///
/// Its faces that keep three or four different nodes are those of the cell, and the six Kuhn
/// tetrahedra around X0-X7 that have a volume fill the cell.
template <class Number>
Hexahedron collapsed(std::span<const Number> c) {
  const auto node = [&](std::size_t i) { return static_cast<Index>(c[i]); };
  switch (c.size()) {
    case 4:
      return {node(0), node(1), node(2), node(2), node(3), node(3), node(3), node(3)};
    case 5:
      return {node(0), node(1), node(3), node(2), node(4), node(4), node(4), node(4)};
    case 6:
      return {node(0), node(1), node(2), node(2), node(3), node(4), node(5), node(5)};
    default:
      return {node(0), node(1), node(3), node(2), node(4), node(5), node(7), node(6)};
  }
}

}  // namespace suture
