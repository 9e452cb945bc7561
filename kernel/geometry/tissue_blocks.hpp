// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernel/geometry/block_lists.hpp"
#include "kernel/geometry/centroids.hpp"

namespace suture {

class Archive;

/// The positions of the tissue before and after a step, and the elements that may meet a box during
/// it: blocks of consecutive elements are tested against the bounding boxes of blocks of
/// consecutive vertices.
///
/// No bound on the motion of a vertex is assumed. Each step reads every position once, which gives
/// the bounding box of each block of vertices (2 ns per vertex: a step of a blade costs as much as
/// copying the positions). A block of elements stores the blocks of vertices that contain the
/// corners of its elements and of their neighbours. A centroid is a mean of corners, so if all of
/// these boxes, before and after the step, lie beyond one side of a given box, then so do both
/// centroids of every link of the block, before and after; only such links are excluded. Centroids
/// are rounded by at most 7 units in the last place of a corner's coordinate, so the box is
/// enlarged by 1e-14 of its bounds.
///
/// Memory: 50 B per vertex, plus the lists.
class TissueBlocks {
 public:
  static constexpr Index size = 32;           ///< elements per block
  static constexpr Index vertices_size = 64;  ///< vertices per block

  /// Forgets everything.
  void clear() { *this = {}; }
  /// True if no positions are known: move() has not been called since clear().
  bool empty() const { return now_.empty(); }

  /// The current positions become the previous ones, and `places` the current ones. At the first
  /// call, and for vertices that follow() did not report, `places` are both, and the function
  /// returns false. O(vertices), at first O(elements).
  bool move(const CellComplex& complex, const Places& places, const Workers* workers);
  /// Call after an operation that moves no vertex, between two calls of move(), with the resulting
  /// `complex`. O(change).
  void follow(const CellComplex& complex, const TopologyChange& change);

  /// For use between two calls of move(): the previous positions are no longer needed.
  void state(Archive& archive);

  /// The blocks with a link whose elements are not both beyond one side of the box before and after
  /// the step, and possibly others. Ascending; block b has the elements from size * b on.
  std::vector<Index> near(const Box& box) const;

  std::vector<Index> all() const;  ///< blocks
  std::size_t block_count() const { return lists_.lists().size(); }
  /// The largest motion in the step of a corner of the block's elements or of their neighbours, m;
  /// a centroid moves no farther. O(vertices there), once per step.
  double moved(Index block);

  Places before() const { return {before_.data()->data(), 3}; }
  Places now() const { return {now_.data()->data(), 3}; }

 private:
  double vertices_moved(Index vertex_block) const;
  void find_boxes(std::size_t first, std::size_t last, const Places& places);

  std::vector<Vec3> before_, now_;             ///< per vertex
  std::vector<Box> boxes_before_, boxes_now_;  ///< per block of vertices
  std::vector<double> moved_;                  ///< per block of vertices; -1: not known yet
  BlockLists lists_{size, {vertices_size}};
};

}  // namespace suture
