// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// The number of blocks of `size` that hold `count` entries.
constexpr Index blocks_of(std::size_t count, Index size) {
  return static_cast<Index>((count + size - 1) / size);
}

/// Blocks of consecutive vertices. Vertices that operations have made may come from anywhere in the
/// body, so that their blocks are small.
struct VertexBlocks {
  Index size;
  Index first_new = none;  ///< a multiple of `size`, or none: all blocks have this size
  static constexpr Index new_size = 8;

  Index of(Index vertex) const {
    return vertex < first_new ? vertex / size : first_new / size + (vertex - first_new) / new_size;
  }
  Index size_at(Index vertex) const { return vertex < first_new ? size : new_size; }
  /// The first vertex of a block.
  Index first(Index block) const {
    const Index large = first_new / size;
    return block < large ? block * size : first_new + (block - large) * new_size;
  }
  /// The number of those of `vertices`.
  Index count(Index vertices) const { return vertices == 0 ? 0 : of(vertices - 1) + 1; }
};

/// By block of consecutive elements, the blocks of consecutive vertices in which the corners of its
/// elements and of their neighbours are, each once.
///
/// Lists only grow with operations, which is sufficient: a cut or a removal takes neighbours away
/// and gives elements new vertices.
class BlockLists {
 public:
  BlockLists(Index elements_per_block, VertexBlocks vertices)
      : elements_(elements_per_block), vertices_(vertices) {}

  /// O(elements).
  void find(const CellComplex& complex);
  /// The same from lists of smaller blocks, whose sizes divide those of these: O(their entries).
  void gather(const BlockLists& finer);
  /// Call after an operation with the resulting `complex`. O(change).
  void follow(const CellComplex& complex, const TopologyChange& change);

  std::vector<std::vector<Index>>& lists() { return lists_; }
  const std::vector<std::vector<Index>>& lists() const { return lists_; }

 private:
  void add(const CellComplex& complex, Index seer, Index seen);
  void add_block(Index seer, Index block);

  Index elements_;
  VertexBlocks vertices_;
  std::vector<std::vector<Index>> lists_;
};

}  // namespace suture
