// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kernel/solvers/node_graph.hpp"

namespace suture {

/// The coarse nodes around every fine node and their weights, which add up to 1: at most 8, and
/// more only at the end of a slit. None for a vertex without an element.
struct Interpolation {
  std::vector<Index> begin;  ///< per fine node, and the end
  std::vector<Index> node;
  std::vector<float> weight;  ///< exact on grids; elsewhere rounded, as good as any other

  Index fine_nodes() const { return static_cast<Index>(begin.size() - 1); }
};
/// P^T, by coarse node: its fine nodes, which ascend, and their weights.
Interpolation transposed(const Interpolation& p, Index coarse_nodes);

/// A level of a hierarchy and its interpolation to the next finer one.
struct Coarsening {
  NodeGraph coarse;
  Interpolation interpolation;
};

/// Trilinear interpolation from a grid that is twice as wide along the short axes of `fine`, and
/// that follows its cells: a coarse node is a point of the grid and one connected component of the
/// fine nodes in its open support (the 8 boxes around it, without their outer faces). The sides of
/// a cut belong to different components, so a slit remains a slit on every level (Dick, Georgii,
/// Burgkart, Westermann, IEEE TVCG 17 (2011) 1663, do so for elements of grids). Where a slit ends
/// in the support, the sides hang together around its end. On grids, they are coarse nodes of their
/// own nevertheless, and share the nodes at the end.
///
/// Coarse nodes are numbered in the order of the fine ones. O(nodes + cells).
Coarsening coarsen(const NodeGraph& fine);

/// Whether each component is held, 3 per node.
using Held = std::vector<std::uint8_t>;

/// A component of a coarse node is free if that of one of its heaviest fine nodes is. (Functions
/// that a support truncates to less than that converge no faster, and make matrices worse.)
Held held_nodes(const Interpolation& interpolation, Index coarse_nodes, const Held& fine);

/// The nodes of pieces with fewer than 6 held components, which may move as rigid bodies. O(cells).
std::vector<bool> loose_nodes(const NodeGraph& graph, const Held& held);
/// The coarse nodes of loose fine nodes. A coarse node never belongs to two pieces.
std::vector<bool> loose_nodes(const Interpolation& interpolation, Index coarse_nodes,
                              const std::vector<bool>& fine);

}  // namespace suture
