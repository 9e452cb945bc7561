// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// Number of a cell's nodes in a batch: 1 (vertex), 2 (edge), 4 (face), 8 (element).
inline constexpr int nodes_of_cell(int dimension) { return 1 << dimension; }

/// The corners (0..7) of a cell in the element that represents it, in the order of every batch: an
/// edge as in suture_hexahedron_edges, a face with its normal outward, both in the element of their
/// dart_of (side 0); an element X0..X7. Returns that element. O(1).
inline Index cell_corners(const CellComplex& complex, int dimension, Index cell,
                          hexahedron::Local* corners) {
  using hexahedron::Local;
  if (dimension == 3) {
    for (Local i = 0; i < hexahedron::vertices; ++i) corners[i] = i;
    return cell;
  }
  const Dart dart = complex.dart_of(dimension, cell);
  const Dart local = dart % hexahedron::darts;
  if (dimension == 0) {
    corners[0] = hexahedron::dart_vertex[local];
  } else if (dimension == 1) {
    const auto& ends = hexahedron::edge_vertices[hexahedron::dart_edge[local]];
    corners[0] = ends[0];
    corners[1] = ends[1];
  } else {
    // The darts of a face run counter-clockwise as seen from inside, hence the reverse order.
    const Dart face = local / 4 * 4;
    for (Dart i = 0; i < 4; ++i) corners[i] = hexahedron::dart_vertex[face + (4 - i) % 4];
  }
  return dart / hexahedron::darts;
}

/// The cells of one dimension of an element; for dimension 3 the element itself, which must outlive
/// the span.
inline std::span<const Index> cells_of_element(const CellComplex& complex, int dimension,
                                               const Index& element) {
  if (dimension == 0) return complex.vertices_of(element);
  if (dimension == 1) return complex.edges_of(element);
  if (dimension == 2) return complex.faces_of(element);
  return {&element, 1};
}

/// The vertices at these corners. O(1).
inline void cell_nodes(const CellComplex& complex, int dimension, Index cell, Index* nodes) {
  hexahedron::Local corners[hexahedron::vertices];
  const Hexahedron& x = complex.vertices_of(cell_corners(complex, dimension, cell, corners));
  for (int i = 0; i < nodes_of_cell(dimension); ++i) nodes[i] = x[corners[i]];
}

}  // namespace suture
