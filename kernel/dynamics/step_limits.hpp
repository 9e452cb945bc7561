// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/dynamics/changed_vertices.hpp"
#include "kernel/dynamics/step_bounds.hpp"
#include "kernel/dynamics/step_search.hpp"

namespace suture {

/// How long a step of a body may be: the limit of all its terms together, and bounds on its safe
/// side that cost less. Follows the body's operations.
class StepLimits : private Follower {
 public:
  explicit StepLimits(Body& body);

  /// The largest stable step of the present state, s; infinite without forces. From
  /// the tangent (step_search.hpp) if every term has one, else from bounds().
  /// Throws PluginError for a functor that offers neither. `from_random`: the search forgets
  /// the mode that it found last, and overlooks none.
  double stable_step(double time, bool from_random = false);
  /// Bounds per vertex on the safe side, cell by cell: for springs and blocks the step
  /// is 0.6 to 0.75 of stable_step(). Throws PluginError for a functor without
  /// suture.stable-dt/1.
  StepBounds bounds(double time);
  /// bounds() of these vertices alone, each given once, to the rounding of another order.
  /// O(cells around them); the first time memory for all vertices is set up.
  StepBounds bounds_at(std::span<const Index> vertices, double time);
  /// bounds() of the vertices that operations changed since the last call, and of no
  /// others: the step stays stable below both the stable step before and this one.
  /// O(cells changed).
  StepBounds bounds_of_changes(double time);

  void state(Archive& archive);

 private:
  void follow(const CellComplex& complex, const TopologyChange& change) override;

  Body& body_;
  StepSearch search_;
  ChangedVertices changed_;  ///< since bounds_of_changes()
  VertexSelection selection_;
};

}  // namespace suture
