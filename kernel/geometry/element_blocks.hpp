// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "kernel/base/box.hpp"
#include "kernel/geometry/block_lists.hpp"
#include "kernel/geometry/centroids.hpp"

namespace suture {

/// Where blocks of consecutive elements are, so that a search by place looks at those nearby only:
/// the bounding boxes of blocks of consecutive vertices, and by block of elements those in which
/// the corners of its elements and of their neighbours are. Blocks have three sizes: a search looks
/// at those of level 0 first, and at smaller ones in those that are near.
///
///   level   elements   vertices, and 8 of those that operations have made
///     0       2,048      1,024
///     1         256        128
///     2          32         32
///
/// Memory: 2 B per vertex, and 6 B per element.
class ElementBlocks {
 public:
  static constexpr std::size_t levels = 3;
  static constexpr std::array<Index, levels> sizes{2048, 256, 32};  ///< elements
  static constexpr Index vertices_read = 1024;                      ///< the unit of read()

  /// O(elements), about 100 ns each.
  ElementBlocks(const CellComplex& complex, const Places& places);

  /// Reads the places of vertices again; `first` is a multiple of vertices_read, and so is `last`
  /// but at the end. May be called on any thread. 1 ns per vertex.
  void read(Index first, Index last, const Places& places);
  /// Call after an operation that has made no copies of elements, with the `complex` and the places
  /// that result. O(change).
  void follow(const CellComplex& complex, const TopologyChange& change, const Places& places);

  Index count(std::size_t level) const { return levels_[level].count(); }
  /// The box of the corners of its elements and of their neighbours, enlarged for the rounding of
  /// centroids; empty (low > high) without elements.
  Box box(std::size_t level, Index block) const { return levels_[level].box(block); }

 private:
  struct Boxes {
    Boxes(Index elements_per_block, VertexBlocks vertices, Index vertex_count);

    VertexBlocks vertices;
    BlockLists lists;
    std::vector<Box> of_vertices;  ///< by block of vertices

    Index count() const { return static_cast<Index>(lists.lists().size()); }
    Box box(Index block) const;
    void follow(const CellComplex& complex, const TopologyChange& change, const Places& places);
  };
  Box read(std::size_t level, Index first, Index last, const Places& places);

  std::vector<Boxes> levels_;
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

  bool contains(Index e) const {
    return sections_.empty() || (sections_[e / section] >> (e % section / block) & 1) != 0;
  }
  /// Where a table of slot_count() rows has the row of a searched element.
  std::size_t slot(Index e) const {
    return sections_.empty() ? e : sections_[e / section] / near_bits * section + e % section;
  }
  std::size_t slot_count() const {
    return sections_.empty() ? count_ : std::size_t{near_sections_} * section;
  }
  /// Calls visit(element) for each, ascending.
  template <class Visit>
  void for_each(Visit visit) const {
    for (const auto& [begin, end] : ranges_)
      for (Index e = begin; e < end; ++e) visit(e);
  }
  /// The same in ranges of at most those of level 0.
  std::span<const ElementRange> ranges() const { return ranges_; }

 private:
  /// Blocks of level 1, which have rows, and of level 2, which are searched.
  static constexpr Index section = ElementBlocks::sizes[1], block = ElementBlocks::sizes[2];
  static constexpr std::uint32_t near_bits = std::uint32_t{1} << section / block;

  void search(const ElementBlocks& blocks, std::size_t level, Index begin, Index end,
              const std::function<bool(const Box&)>& may_hold);
  void add(Index begin, Index end);

  Index count_;
  std::vector<ElementRange> ranges_;
  /// By section: near_bits times its number among those with rows, plus a bit for each of its
  /// blocks that is searched. Empty: all are searched.
  std::vector<std::uint32_t> sections_;
  std::uint32_t near_sections_ = 0;
};

/// The least and the largest of n . (x - point) for x in a box, enlarged for rounding.
std::array<double, 2> heights_of(const Box& box, const Vec3& point, const Vec3& n);

}  // namespace suture
