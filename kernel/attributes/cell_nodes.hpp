// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// Numbers of a cell's nodes in a batch: 2 (edge), 4 (face), 8 (element).
inline constexpr int nodes_of_cell(int dimension) { return 1 << dimension; }

/// Vertices of a cell of dimension 1..3, as every batch lists them: an edge in the
/// order of suture_hexahedron_edges, a face outward from the element of its
/// dart_of (side 0), an element X0..X7. O(1).
inline void cell_nodes(const CellComplex& complex, int dimension, Index cell, Index* nodes) {
  if (dimension == 3) {
    const Hexahedron& x = complex.vertices_of(cell);
    for (std::size_t i = 0; i < x.size(); ++i) nodes[i] = x[i];
    return;
  }
  const Dart dart = complex.dart_of(dimension, cell);
  const Hexahedron& x = complex.vertices_of(dart / hexahedron::darts);
  const Dart local = dart % hexahedron::darts;
  if (dimension == 1) {
    const auto& ends = hexahedron::edge_vertices[hexahedron::dart_edge[local]];
    nodes[0] = x[ends[0]];
    nodes[1] = x[ends[1]];
    return;
  }
  // The darts of a face turn counter-clockwise seen from inside: reversed.
  const Dart face = local / 4 * 4;
  for (Dart i = 0; i < 4; ++i) nodes[i] = x[hexahedron::dart_vertex[face + (4 - i) % 4]];
}

}  // namespace suture
