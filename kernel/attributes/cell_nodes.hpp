// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// Numbers of a cell's nodes in a batch: 2 (edge), 4 (face), 8 (element).
inline constexpr int nodes_of_cell(int dimension) { return 1 << dimension; }

/// Corners 0..7 of a cell of dimension 1..3 in the element that stands for it, as every
/// batch lists them: an edge in the order of suture_hexahedron_edges, a face outward,
/// both of the element of its dart_of (side 0), an element X0..X7. Returns that element.
/// O(1).
inline Index cell_corners(const CellComplex& complex, int dimension, Index cell,
                          hexahedron::Local* corners) {
  using hexahedron::Local;
  if (dimension == 3) {
    for (Local i = 0; i < hexahedron::vertices; ++i) corners[i] = i;
    return cell;
  }
  const Dart dart = complex.dart_of(dimension, cell);
  const Dart local = dart % hexahedron::darts;
  if (dimension == 1) {
    const auto& ends = hexahedron::edge_vertices[hexahedron::dart_edge[local]];
    corners[0] = ends[0];
    corners[1] = ends[1];
  } else {
    // The darts of a face turn counter-clockwise seen from inside: reversed.
    const Dart face = local / 4 * 4;
    for (Dart i = 0; i < 4; ++i) corners[i] = hexahedron::dart_vertex[face + (4 - i) % 4];
  }
  return dart / hexahedron::darts;
}

/// The vertices there. O(1).
inline void cell_nodes(const CellComplex& complex, int dimension, Index cell, Index* nodes) {
  hexahedron::Local corners[hexahedron::vertices];
  const Hexahedron& x = complex.vertices_of(cell_corners(complex, dimension, cell, corners));
  for (int i = 0; i < nodes_of_cell(dimension); ++i) nodes[i] = x[corners[i]];
}

}  // namespace suture
