// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// An operation that is about to be performed.
struct ComingOperation {
  /// The vertices that it separates or moves, or at which it changes forces, each once, ascending.
  std::span<const Index> vertices;
  bool only_apart;  ///< no element is removed or joined
};

/// An object that is notified of operations on a body (Body::add_follower).
class Follower {
 public:
  virtual ~Follower() = default;
  /// Called before the operation, which may still be refused. May read the state.
  virtual void before(const ComingOperation&) {}
  /// Called after the operation, when the attributes have been updated. O(change).
  virtual void follow(const CellComplex& complex, const TopologyChange& change) = 0;
};

}  // namespace suture
