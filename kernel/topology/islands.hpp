// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// What an operation changed in the islands.
struct IslandChange {
  std::vector<Split> splits;   ///< parts that separated from an island, by new number
  std::vector<Merge> merges;   ///< by `kept`, then `gone`
  std::vector<Index> removed;  ///< islands whose last element was removed, ascending
  /// Islands with an element of the change, in their state after the operation, ascending: new
  /// ones, those that lost or gained elements, and those that were cut without separating.
  std::vector<Index> touched;
};

/// The connected components of a map, kept up to date through all operations.
///
/// Numbers are dense, permanent and never reused, like those of cells. Initially they follow the
/// order of the smallest elements. When an island falls apart, the part with the most elements
/// keeps the number (among equals, the part with the smallest element), so that a body keeps its
/// number while crumbs fall off; the other parts get new numbers in the order of their smallest
/// elements. When islands are sewn together, the number of the one with the most elements is kept
/// (among equals, the smallest number).
///
/// Memory: 8 B per element.
class Islands {
 public:
  explicit Islands(const CellComplex& complex);

  /// Updates the islands after an operation on `complex`. Cost: the elements of the change, plus
  /// those of all parts except the largest of each island that falls apart, or of all except the
  /// largest of the islands that are sewn together. If a cut separates nothing, the searches from
  /// its two sides end where they meet.
  IslandChange update(const CellComplex& complex, const TopologyChange& change);

  /// The number of islands so far, including former ones with size() 0.
  Index count() const { return static_cast<Index>(size_.size()); }
  /// The number of existing islands.
  Index existing() const { return existing_; }
  /// The number of elements of an island. O(1).
  Index size(Index island) const { return size_[island]; }
  /// An element of an island, `none` of a former one. O(1).
  Index representative(Index island) const {
    return size_[island] == 0 ? none : representative_[island];
  }
  /// The island of an element, `none` if it was removed. O(1).
  Index of(Index element) const { return island_[element]; }
  /// of() for all elements.
  std::span<const Index> of_elements() const { return island_; }
  /// The elements of an island, ascending. O(n log n) in its size.
  std::vector<Index> elements(const CellComplex& complex, Index island);
  /// Islands of fewer than `elements` elements, ascending. O(count()).
  std::vector<Index> smaller_than(Index elements) const;

  /// Compares the islands with the components of the whole map; throws TopologyError naming the
  /// element or island that differs. O(elements).
  void validate(const CellComplex& complex) const;

  /// Must be loaded into islands of the same mesh.
  void state(Archive& archive);

 private:
  struct Part;
  class ComponentSearch;

  void add_copies(std::span<const Split> copies);
  void forget(std::span<const Index> removed, IslandChange& result);
  void join(const CellComplex& complex, const TopologyChange& change, IslandChange& result);
  void split(const CellComplex& complex, const TopologyChange& change, IslandChange& result);
  void rename(const CellComplex& complex, Index from, Index to);
  std::vector<Part> first_parts(const CellComplex& complex, std::span<const Index> seeds);
  void separate(const CellComplex& complex, std::vector<Part>& parts, std::vector<Part>& leaving);

  std::vector<Index> island_;          ///< per element
  std::vector<Index> size_;            ///< per island
  std::vector<Index> representative_;  ///< per island, one of its elements
  Index existing_ = 0;
  /// Per element: the search that visited it; `none` between operations.
  std::vector<Index> reached_;
};

}  // namespace suture
