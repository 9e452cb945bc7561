// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernel/geometry/centroids.hpp"

namespace suture {

class Archive;

/// Where the tissue was and is in a step, and which of its elements may meet a box then:
/// blocks of consecutive elements against boxes of blocks of consecutive vertices.
///
/// Nothing is assumed of how far a vertex moves. Each step reads every position once, which
/// gives the box of each block of vertices (2 ns per vertex: a step of a blade costs what it
/// costs to copy the positions). A block of elements knows the blocks of vertices
/// that the corners of its elements and of their neighbours lie in. A centroid is a mean of
/// corners, so if all of these boxes, before and after the step, lie beyond one side of a
/// given box, then so do both centroids of every link of the block, before and after; and
/// only such links are left out. Centroids are rounded, by 7 units in the last place of a
/// corner's coordinate at most: the box is enlarged by 1e-14 of its bounds.
///
/// Lists of blocks only grow with operations (follow()), so they hold what they must:
/// a cut or a removal takes neighbours away and gives elements new vertices.
///
/// Memory: 50 B per vertex, and the lists.
class TissueBlocks {
 public:
  static constexpr Index size = 32;           ///< elements of a block
  static constexpr Index vertices_size = 64;  ///< vertices of a block

  /// Nothing is known.
  void clear() { *this = {}; }
  /// No place is known: move() has not been called since clear().
  bool empty() const { return now_.empty(); }

  /// What was now is before; `places` are now. The first time both, and so for vertices that
  /// follow() was not told of; then it returns false. O(vertices), then O(elements).
  bool move(const CellComplex& complex, const Places& places, const Workers* workers);
  /// An operation that moves no vertex was made, between two calls of move(); `complex` as it
  /// is afterwards. O(change).
  void follow(const CellComplex& complex, const TopologyChange& change);

  /// Between two calls of move(): what was before does not matter any more.
  void state(Archive& archive);

  /// Blocks of elements with a link that has not both elements beyond one side of the box
  /// before and now, and some others. Ascending; block b has the elements from size * b on.
  std::vector<Index> near(const Box& box) const;

  std::vector<Index> all() const;  ///< blocks
  std::size_t block_count() const { return lists_.size(); }
  /// The farthest that a corner of the block's elements, or of their neighbours, has moved
  /// in the step, m; a centroid moves no farther. O(vertices there), once per step.
  double moved(Index block);

  Places before() const { return {before_.data()->data(), 3}; }
  Places now() const { return {now_.data()->data(), 3}; }

 private:
  double vertices_moved(Index vertex_block) const;
  void find_boxes(std::size_t first, std::size_t last, const Places& places);
  void find_lists(const CellComplex& complex);

  std::vector<Vec3> before_, now_;             ///< per vertex
  std::vector<Box> boxes_before_, boxes_now_;  ///< per block of vertices
  std::vector<double> moved_;                  ///< per block of vertices; -1: not known yet
  /// Per block of elements: the blocks of vertices that it depends on, each once.
  std::vector<std::vector<Index>> lists_;
};

}  // namespace suture
