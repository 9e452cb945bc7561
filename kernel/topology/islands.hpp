// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// What an operation did to the islands.
struct IslandChange {
  std::vector<Split> splits;   ///< parts that left an island, by new number
  std::vector<Merge> merges;   ///< by `kept`, then `gone`
  std::vector<Index> removed;  ///< whose last element was removed, ascending
  /// Islands that hold an element of the change, as they are afterwards, ascending:
  /// new ones, those that lost or gained elements, those that were only cut into.
  std::vector<Index> touched;
};

/// The connected components of a map, known through all its operations.
///
/// Numbers are dense, never move and are never reused, as those of cells. At first they
/// follow the smallest elements. When an island falls apart the part with the most
/// elements keeps the number (among equals that with the smallest element), so that a
/// body stays itself while crumbs fall off; the other parts of an operation get new
/// numbers in order of their smallest elements. When islands are sewn together the one
/// with the most elements stays (among equals the smallest number).
///
/// Memory: 8 B per element.
class Islands {
 public:
  explicit Islands(const CellComplex& complex);

  /// Follows an operation; `complex` as it is after it. Cost: the elements of the
  /// change, and those of all parts but the largest of each island that falls apart, or
  /// of all but the largest of those that are sewn together. Where a cut separates
  /// nothing the searches from its two sides end where they meet.
  IslandChange update(const CellComplex& complex, const TopologyChange& change);

  /// Numbers given so far; those with size() 0 are no more.
  Index count() const { return static_cast<Index>(size_.size()); }
  /// Islands that are there.
  Index existing() const { return existing_; }
  /// Elements of an island. O(1).
  Index size(Index island) const { return size_[island]; }
  /// The island of an element, `none` if it was removed. O(1).
  Index of(Index element) const { return island_[element]; }
  /// of() for all elements.
  std::span<const Index> of_elements() const { return island_; }
  /// The elements of an island, ascending. O(n log n) in its size.
  std::vector<Index> elements(const CellComplex& complex, Index island);
  /// Islands of fewer than `elements` elements, ascending. O(count()).
  std::vector<Index> smaller_than(Index elements) const;

  /// Compares with the components that the map finds in whole; throws TopologyError
  /// naming the element or island that differs. O(elements).
  void validate(const CellComplex& complex) const;

  /// To be loaded where islands of the same mesh are.
  void state(Archive& archive);

 private:
  struct Part;
  class Race;

  void forget(std::span<const Index> removed, IslandChange& result);
  void join(const CellComplex& complex, const TopologyChange& change, IslandChange& result);
  void part(const CellComplex& complex, const TopologyChange& change, IslandChange& result);
  void rename(const CellComplex& complex, Index from, Index to);
  std::vector<Part> first_parts(const CellComplex& complex, std::span<const Index> seeds);
  void separate(const CellComplex& complex, std::vector<Part>& parts, std::vector<Part>& leaving);

  std::vector<Index> island_;  ///< per element
  std::vector<Index> size_;    ///< per island
  std::vector<Index> some_;    ///< per island, one of its elements
  Index existing_ = 0;
  /// Per element: which search has been there; `none` between operations.
  std::vector<Index> reached_;
};

}  // namespace suture
