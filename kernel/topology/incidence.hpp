// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/topology/cell_complex.hpp"

namespace suture::incidence {

// Steps of the map between the incidences of a cell with its elements. An
// element meets a vertex in a corner, an edge in an element-edge, a face in a side;
// the lowest dart of the element in that cell stands for it ("canonical").
// One template for the dimensions: the walks of cell_complex.cpp and cut.cpp are
// written once.

/// Local cell (corner, edge or side) of a local dart.
template <int Dimension>
constexpr int local_cell(int dart) {
  if constexpr (Dimension == 0) return hexahedron::dart_vertex[dart];
  if constexpr (Dimension == 1) return hexahedron::dart_edge[dart];
  return dart / 4;
}

/// The local darts through whose faces an element's neighbours around the cell are
/// reached: 3 for a corner, 2 for an edge, 1 for a side; the first is canonical.
template <int Dimension>
constexpr auto exits(int local) {
  if constexpr (Dimension == 0) return hexahedron::vertex_darts[local];
  if constexpr (Dimension == 1) return hexahedron::edge_darts[local];
  if constexpr (Dimension == 2) return std::array{static_cast<hexahedron::Local>(4 * local)};
}

template <int Dimension>
constexpr Dart canonical(Dart d) {
  const Dart local = d % 24;
  return d - local + exits<Dimension>(local_cell<Dimension>(static_cast<int>(local)))[0];
}

/// The dart of the same vertex, edge or face across the face of d, given beta3(d):
/// beta3 turns a dart round, so its vertex is found one further.
template <int Dimension>
constexpr Dart landing(Dart beta3_of_d) {
  return Dimension == 0 ? CellComplex::beta1(beta3_of_d) : beta3_of_d;
}

}  // namespace suture::incidence
