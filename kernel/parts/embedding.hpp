// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "kernel/mesh/parts.hpp"
#include "kernel/topology/import.hpp"

namespace suture {

/// The parts of a mesh by the numbers of its elements in a complex, in their order.
Parts renumbered(Parts parts, const Renumbering& element_of);

/// Points, each a combination of vertices: point p has the vertices and weights from first[p] to
/// first[p + 1].
struct EmbeddedPoints {
  std::vector<Index> first{0};
  std::vector<Index> vertices;
  std::vector<double> weights;

  std::size_t size() const { return first.size() - 1; }
  /// The vertex in whose place a point lies; else none.
  Index vertex(std::size_t p) const {
    return first[p + 1] - first[p] == 1 ? vertices[first[p]] : none;
  }
  /// The sum of weight times value of the vertices: component c of vertex v is at
  /// values[stride * v + c].
  double value(std::size_t p, const double* values, std::size_t stride, std::size_t c) const {
    double sum = 0;
    for (Index i = first[p]; i < first[p + 1]; ++i)
      sum += weights[i] * values[stride * vertices[i] + c];
    return sum;
  }
};

/// The partial elements of a body and its surface, on the vertices of the complex as it is now.
/// Points are shared by the elements that share the vertices on which they depend: a cut opens the
/// surface, too. Made again after an operation: 0.1 us per point of the parts.
struct Embedding {
  EmbeddedPoints points;

  std::vector<std::array<Index, 4>> tetrahedra;  ///< of existing partial elements, ascending
  std::vector<Index> tetrahedron_element;

  /// The surface, closed and oriented outwards: of the body, and the faces that cuts and removals
  /// have laid open.
  std::vector<std::array<Index, 3>> triangles;
  std::vector<Index> triangle_element;
  std::vector<std::uint8_t> is_laid_open;  ///< by triangle
  /// By triangle: its number in the parts, or, behind these, 6 e + f on side f of element e.
  std::vector<Index> triangle_source;

  Embedding() = default;
  Embedding(const Parts& parts, const CellComplex& complex);
};

/// The weights of the nodes X0..X7 at a place in the reference cube [-1, 1]^3.
std::array<double, 8> trilinear_weights(const Vec3& at);
/// The place in the body, where vertex v is at rows[stride v].
Vec3 place_in(const Hexahedron& nodes, const Vec3& at, const double* rows, std::size_t stride);

}  // namespace suture
