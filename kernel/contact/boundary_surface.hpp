// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kernel/base/archive.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// Numbers in a list without gaps: inserted and erased in O(1). Their order depends on the history.
class DenseSet {
 public:
  std::span<const Index> items() const { return items_; }
  bool contains(Index item) const { return item < place_.size() && place_[item] != none; }
  /// Where the item is in items(); it must be there.
  Index place(Index item) const { return place_[item]; }
  void insert(Index item);
  /// The last item takes the place of the erased one.
  void erase(Index item);
  void clear();  ///< O(items)
  void state(Archive& archive);

 private:
  std::vector<Index> items_;
  std::vector<Index> place_;  ///< by item; none: not in the set
};

/// The 2-boundary of a map: faces without a neighbour, with their vertices and edges. It follows
/// operations in time proportional to the change.
class BoundarySurface {
 public:
  /// The vertices of a face, counterclockwise as seen from outside.
  using Corners = std::array<Index, 4>;

  explicit BoundarySurface(const CellComplex& complex);

  /// Faces, as 6 e + f: face f of element e.
  std::span<const Index> faces() const { return faces_.items(); }
  /// In the order of faces().
  std::span<const Corners> corners() const { return corners_; }
  /// Where a face of the boundary is in faces().
  Index place(Index face) const { return faces_.place(face); }
  std::span<const Index> vertices() const { return vertices_.items(); }
  /// The same in ascending order, in which their rows are fast to visit. O(highest vertex).
  std::vector<Index> ascending_vertices() const;
  bool has_vertex(Index vertex) const { return vertices_.contains(vertex); }

  /// Call after an operation. O(change).
  void follow(const CellComplex& complex, const TopologyChange& change);
  void state(Archive& archive);

 private:
  void update(const CellComplex& complex, Index element);
  void add(const CellComplex& complex, Index face);
  void remove(Index face);
  void count_corners();

  DenseSet faces_, vertices_;
  std::vector<Corners> corners_;
  std::vector<Index> uses_;  ///< by vertex: the faces around it
};

}  // namespace suture
