// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

/// The darts of one hexahedron as data. Everything is derived from two tables: the start nodes of
/// the paper's dart[6][4] (with the numbering of CGAL's make_hexahedron), and the vertex pairs of
/// the edges. Another cell type needs another pair of tables.
namespace suture::hexahedron {

using Local = std::uint8_t;  ///< number of a vertex, edge, face or dart inside the cell

inline constexpr int vertices = 8, edges = 12, faces = 6, darts = 24, darts_per_face = 4;

/// Origin of dart 4 f + k: position k of face f = x0, y0, x1, y1, z0, z1. Faces run
/// counterclockwise as seen from inside; X_i = (i&1, (i>>1)&1, (i>>2)&1).
inline constexpr std::array<Local, darts> dart_vertex = {
    2, 6, 4, 0,  //
    0, 4, 5, 1,  //
    1, 5, 7, 3,  //
    3, 7, 6, 2,  //
    2, 0, 1, 3,  //
    6, 7, 5, 4,
};

/// Ends of the edges: 0..3 along x, 4..7 along y, 8..11 along z.
inline constexpr std::array<std::array<Local, 2>, edges> edge_vertices = {{
    {0, 1},
    {2, 3},
    {4, 5},
    {6, 7},  //
    {0, 2},
    {1, 3},
    {4, 6},
    {5, 7},  //
    {0, 4},
    {1, 5},
    {2, 6},
    {3, 7},
}};

/// Next and previous dart around the face.
inline constexpr int beta1(int dart) { return (dart & ~3) | ((dart + 1) & 3); }
inline constexpr int beta0(int dart) { return (dart & ~3) | ((dart + 3) & 3); }

namespace detail {

constexpr std::array<Local, darts> make_beta2() {
  std::array<Local, darts> result{};
  for (int d = 0; d < darts; ++d)
    for (int o = 0; o < darts; ++o)
      if (dart_vertex[o] == dart_vertex[beta1(d)] && dart_vertex[beta1(o)] == dart_vertex[d])
        result[d] = static_cast<Local>(o);
  return result;
}

constexpr std::array<Local, darts> make_dart_edge() {
  std::array<Local, darts> result{};
  for (int d = 0; d < darts; ++d)
    for (int e = 0; e < edges; ++e) {
      const Local a = dart_vertex[d], b = dart_vertex[beta1(d)];
      const auto [p, q] = edge_vertices[e];
      if ((a == p && b == q) || (a == q && b == p)) result[d] = static_cast<Local>(e);
    }
  return result;
}

/// For each of `Cells` local cells, the darts that `cell_of` maps to it, ascending.
template <int Cells>
constexpr auto invert(const std::array<Local, darts>& cell_of) {
  std::array<std::array<Local, darts / Cells>, Cells> result{};
  std::array<int, Cells> found{};
  for (int d = 0; d < darts; ++d) result[cell_of[d]][found[cell_of[d]]++] = static_cast<Local>(d);
  return result;
}

}  // namespace detail

/// The dart of the same edge in the neighbouring face of the same element.
inline constexpr std::array<Local, darts> beta2 = detail::make_beta2();
inline constexpr std::array<Local, darts> dart_edge = detail::make_dart_edge();
/// The three darts that start at a vertex, and the two on an edge. The first one represents the
/// (element, vertex) or (element, edge) incidence in stars.
inline constexpr auto vertex_darts = detail::invert<vertices>(dart_vertex);
inline constexpr auto edge_darts = detail::invert<edges>(dart_edge);

// Entries stated in the text of the paper.
static_assert(dart_vertex[4 * 0 + 3] == 0 && dart_vertex[4 * 1 + 0] == 0);
static_assert(dart_vertex[4 * 4 + 1] == 0 && dart_vertex[4 * 4 + 2] == 1);
static_assert(dart_vertex[4 * 3 + 1] == 7);

// beta2 is a fixed-point-free involution between different faces (each edge lies in exactly two),
// and neighbouring faces traverse their common edge in opposite directions.
static_assert([] {
  for (int d = 0; d < darts; ++d) {
    const int o = beta2[d];
    if (beta2[o] != d || o / 4 == d / 4 || dart_edge[o] != dart_edge[d]) return false;
    if (dart_vertex[d] != dart_vertex[beta1(o)] || beta0(beta1(d)) != d) return false;
  }
  return true;
}());

}  // namespace suture::hexahedron
