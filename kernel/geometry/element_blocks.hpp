// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "kernel/base/box.hpp"
#include "kernel/geometry/block_lists.hpp"
#include "kernel/geometry/centroids.hpp"

namespace suture {

/// Where blocks of consecutive elements are, so that a search by place looks at those nearby only:
/// the bounding boxes of blocks of consecutive vertices, and by block of elements those in which
/// the corners of its elements and of their neighbours are.
///
/// Memory: 0.1 B per vertex, and 0.1 B per element.
class ElementBlocks {
 public:
  static constexpr Index size = 1024;  ///< elements, and vertices

  /// O(elements), about 10 ns each.
  ElementBlocks(const CellComplex& complex, const Places& places);

  /// Reads the places of vertices again: of whole blocks, but for the last. May be called on any
  /// thread. 1 ns per vertex.
  void read(Index first, Index last, const Places& places);
  /// Call after an operation that has made no copies of elements, with the `complex` and the places
  /// that result. O(change).
  void follow(const CellComplex& complex, const TopologyChange& change, const Places& places);

  /// By block, the box of the corners of its elements and of their neighbours, enlarged for the
  /// rounding of centroids. O(blocks).
  std::vector<Box> boxes() const;

 private:
  std::vector<Box> boxes_;  ///< by block of vertices
  BlockLists lists_{size, size};
};

/// The elements at which a search by place looks.
class SearchedElements {
 public:
  explicit SearchedElements(Index all) : count_(all) {}
  /// Those of blocks with a box that may hold something; all without `blocks`.
  SearchedElements(const ElementBlocks* blocks, Index count,
                   const std::function<bool(const Box&)>& may_hold);

  bool contains(Index e) const {
    return is_near_.empty() || is_near_[e / ElementBlocks::size] != 0;
  }
  /// Calls visit(element) for each, ascending.
  template <class Visit>
  void for_each(Visit visit) const {
    for (const auto& [begin, end] : ranges())
      for (Index e = begin; e < end; ++e) visit(e);
  }
  /// The same in blocks.
  std::vector<ElementRange> ranges() const;

 private:
  Index count_;
  std::vector<char> is_near_;  ///< by block; empty: all
};

/// The least and the largest of n . (x - point) for x in a box, enlarged for rounding.
std::array<double, 2> heights_of(const Box& box, const Vec3& point, const Vec3& n);

}  // namespace suture
