// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "kernel/base/types.hpp"
#include "kernel/topology/hexahedron_tables.hpp"

/// Steps from element to element around a cell, for the walks of cell_complex.cpp and cut.cpp: the
/// same code for all dimensions, with tables and without division.
namespace suture::incidence {

using hexahedron::Local;

/// A dart, or `none`, in the form in which beta3 is stored: element << 5 | local dart. Decoding
/// needs shifts, whereas 24 e + d needs a division (a third of the time of a cut). The highest bit
/// is reserved for marks, so there are fewer than 2^26 elements (`max_elements`).
using Link = std::uint32_t;
inline constexpr Link link_of(Index element, unsigned dart) { return element << 5 | dart; }
inline constexpr Dart dart_of(Link link) { return 24 * (link >> 5) + (link & 31); }

/// An element and one of its vertices, edges or faces: element << 4 | local cell.
using LocalCell = std::uint32_t;

template <int Dimension>
inline constexpr int cells = Dimension == 0   ? 8
                             : Dimension == 1 ? 12
                                              : 6;

/// The local vertex, edge or face of a local dart.
template <int Dimension>
constexpr Local local_of(int dart) {
  if constexpr (Dimension == 0) return hexahedron::dart_vertex[dart];
  if constexpr (Dimension == 1) return hexahedron::dart_edge[dart];
  return static_cast<Local>(dart / 4);
}

/// A face through which a neighbour of the element around a cell is reached (3 at a vertex, 2 at an
/// edge, the face itself), and the position of the cell on it.
struct Exit {
  Local face;
  Local position;  ///< k of the dart 4 face + k of the cell
};

template <int Dimension>
inline constexpr auto exits = [] {
  std::array<std::array<Exit, Dimension == 2 ? 1 : 3 - Dimension>, cells<Dimension>> result{};
  std::array<int, cells<Dimension>> found{};
  for (int d = 0; d < hexahedron::darts; ++d) {
    if (Dimension == 2 && d % 4 != 0) continue;
    const int cell = local_of<Dimension>(d);
    result[cell][found[cell]++] = {static_cast<Local>(d / 4), static_cast<Local>(d % 4)};
  }
  return result;
}();

/// across[link & 31][k]: the local cell of the neighbour that coincides with that of dart k on this
/// side. beta3(k) = link - k around the face; it runs backwards, so dart k starts at the vertex
/// where the dart after beta3(k) starts.
template <int Dimension>
inline constexpr auto across = [] {
  std::array<std::array<Local, 4>, 32> result{};
  for (int link = 0; link < hexahedron::darts; ++link)
    for (int k = 0; k < 4; ++k)
      result[link][k] =
          local_of<Dimension>((link & ~3) | ((link - k + (Dimension == 0 ? 1 : 0)) & 3));
  return result;
}();

template <int Dimension>
constexpr LocalCell local_cell_of(Dart d) {
  return d / 24 << 4 | local_of<Dimension>(static_cast<int>(d % 24));
}

/// lowest_dart[cell]: the lowest dart of an element in one of its local cells. 16 entries, the
/// range of the local part of a LocalCell.
template <int Dimension>
inline constexpr auto lowest_dart = [] {
  std::array<Local, 16> result{};
  for (int cell = 0; cell < cells<Dimension>; ++cell) {
    const Exit first = exits<Dimension>[cell][0];
    result[cell] = static_cast<Local>(4 * first.face + first.position);
  }
  return result;
}();

/// The dart that represents the LocalCell in stars.
template <int Dimension>
constexpr Dart dart_at(LocalCell place) {
  return 24 * (place >> 4) + lowest_dart<Dimension>[place & 15];
}

}  // namespace suture::incidence
