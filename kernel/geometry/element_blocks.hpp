// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "kernel/base/box.hpp"
#include "kernel/geometry/block_lists.hpp"
#include "kernel/geometry/centroids.hpp"

namespace suture {

/// Where blocks of consecutive elements are, so that a search by place looks at those nearby only:
/// the bounding boxes of blocks of consecutive vertices, and by block of elements those in which
/// the corners of its elements and of their neighbours are. Groups of blocks are searched first.
///
///   elements  |----|----|----|----|----|----|----|----|  blocks of 256
///             |-------------------|-------------------|  groups of 4,096
///   vertices  |--|--|--|--|--|--|--|--|--|--|--|--|--|-  128, for blocks
///             |-----------|-----------|-----------|----  1,024, for groups
///             8 of those that operations have made
///
/// Memory: 0.5 B per vertex, and 0.5 B per element.
class ElementBlocks {
 public:
  static constexpr Index size = 256, group_size = 4096;  ///< elements
  static constexpr Index vertices_read = 1024;           ///< the unit of read()

  /// O(elements), about 20 ns each.
  ElementBlocks(const CellComplex& complex, const Places& places);

  /// Reads the places of vertices again; `first` is a multiple of vertices_read, and so is `last`
  /// but at the end. May be called on any thread. 1 ns per vertex.
  void read(Index first, Index last, const Places& places);
  /// Call after an operation that has made no copies of elements, with the `complex` and the places
  /// that result. O(change).
  void follow(const CellComplex& complex, const TopologyChange& change, const Places& places);

  Index groups() const { return groups_.count(); }
  Index blocks() const { return blocks_.count(); }
  /// The box of the corners of its elements and of their neighbours, enlarged for the rounding of
  /// centroids; empty (low > high) without elements.
  Box group_box(Index group) const { return groups_.box(group); }
  Box box(Index block) const { return blocks_.box(block); }

 private:
  struct Boxes {
    Boxes(Index elements_per_block, VertexBlocks vertices, const CellComplex& complex);

    VertexBlocks vertices;
    BlockLists lists;
    std::vector<Box> of_vertices;  ///< by block of vertices

    Index count() const { return static_cast<Index>(lists.lists().size()); }
    Box box(Index block) const;
    void follow(const CellComplex& complex, const TopologyChange& change, const Places& places);
  };

  static constexpr Index vertices_per_block = 128;
  Boxes groups_, blocks_;
};

/// Consecutive elements.
struct ElementRange {
  Index begin, end;
};

/// The elements at which a search by place looks: those of blocks with a box that may hold
/// something; all without `blocks`.
class SearchedElements {
 public:
  /// `may_hold` is true for a box that holds one for which it is true.
  SearchedElements(const ElementBlocks* blocks, Index count,
                   const std::function<bool(const Box&)>& may_hold);

  bool contains(Index e) const { return slots_.empty() || slots_[e / ElementBlocks::size] != none; }
  /// Where a table of slot_count() rows has the row of a searched element.
  std::size_t slot(Index e) const {
    return slots_.empty() ? e : slots_[e / ElementBlocks::size] + e % ElementBlocks::size;
  }
  std::size_t slot_count() const {
    return slots_.empty() ? count_ : ranges_.size() * ElementBlocks::size;
  }
  /// Calls visit(element) for each, ascending.
  template <class Visit>
  void for_each(Visit visit) const {
    for (const auto& [begin, end] : ranges_)
      for (Index e = begin; e < end; ++e) visit(e);
  }
  /// The same in blocks.
  std::span<const ElementRange> ranges() const { return ranges_; }

 private:
  void add(Index begin, Index size);

  Index count_;
  std::vector<ElementRange> ranges_;
  std::vector<Index> slots_;  ///< by block: of its first element, or none; empty: all are searched
};

/// The least and the largest of n . (x - point) for x in a box, enlarged for rounding.
std::array<double, 2> heights_of(const Box& box, const Vec3& point, const Vec3& n);

}  // namespace suture
