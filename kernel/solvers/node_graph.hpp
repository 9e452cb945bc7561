// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"

namespace suture {

/// The nodes of one level of a hierarchy: where they are, and which of them belong together.
struct NodeGraph {
  /// Multiples of `spacing` from the lower corner of the body at rest; whole numbers on coarse
  /// levels.
  std::vector<Vec3> places;
  Vec3 spacing{};        ///< of the grid of this level along each axis, m
  Vec3 extent{};         ///< of the body in multiples of `spacing`
  bool is_grid = false;  ///< the vertices are points of that grid
  /// Nodes that belong to one cell: an element, or the coarse nodes that elements share.
  std::vector<Index> cell_begin{0}, cell_nodes;

  Index nodes() const { return static_cast<Index>(places.size()); }
  std::size_t cells() const { return cell_begin.size() - 1; }
  std::span<const Index> cell(std::size_t i) const {
    return std::span(cell_nodes).subspan(cell_begin[i], cell_begin[i + 1] - cell_begin[i]);
  }
};

/// The vertices and elements of a body at rest. If all vertices are points of one grid of boxes (a
/// box, voxels, both after cuts), `spacing` is that of the grid. Otherwise it is a whole part of
/// the extent, about a quarter more than the edge of the cube with the mean volume of an element.
/// O(elements).
NodeGraph vertex_graph(const CellComplex& complex, Attributes& attributes);

}  // namespace suture
