// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// An operation that is about to be made.
struct ComingOperation {
  /// That it takes apart, each given once, ascending; none where elements are joined.
  std::span<const Index> vertices;
  bool only_apart;  ///< no element is removed or joined
};

/// Whoever must know of operations on a body (Body::add_follower).
class Follower {
 public:
  virtual ~Follower() = default;
  /// May look at the state as it is before. The operation may still be refused.
  virtual void before(const ComingOperation&) {}
  /// It was made, and the attributes have followed. O(change).
  virtual void follow(const CellComplex& complex, const TopologyChange& change) = 0;
};

}  // namespace suture
