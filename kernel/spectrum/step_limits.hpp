// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "kernel/spectrum/changed_vertices.hpp"
#include "kernel/spectrum/step_bounds.hpp"
#include "kernel/spectrum/step_search.hpp"

namespace suture {

/// The limits on the step of a body: the stability limit of all its terms together, and cheaper
/// conservative bounds. Follows the operations on the body.
class StepLimits : private Follower {
 public:
  explicit StepLimits(Body& body);

  /// The largest stable step in the current state, s; infinite without forces. Computed from the
  /// tangent (step_search.hpp) if every term has one, otherwise from bounds(). Throws NoStepBound
  /// for a functor that offers neither. `from_random`: the search does not start from the last
  /// mode, so that it overlooks none.
  double stable_step(double time, bool from_random = false);
  /// Conservative bounds per vertex, computed cell by cell: for springs and blocks the step is 0.6
  /// to 0.75 of stable_step(). Throws NoStepBound for a functor without suture.stable-dt/1.
  StepBounds bounds(double time);
  /// bounds() of these vertices only, each given once; they agree to within the rounding of a
  /// different order of summation. O(cells around them); the first call allocates memory for all
  /// vertices.
  StepBounds bounds_at(std::span<const Index> vertices, double time);
  /// bounds() of the vertices that operations changed since the last call only: a step is stable if
  /// it is below both the previous stable step and this bound. O(cells changed).
  StepBounds bounds_of_changes(double time);

  /// A computation of the limits that is spread over the steps of a run, so that no step takes much
  /// longer than the others: begin(), then advance() after each step.
  enum class Aim { stable_step, bound, both };
  struct Found {
    double stable;  ///< s; the bound where only that was asked for, or only that is known
    double bound;   ///< s; infinite if it was not asked for, or a functor offers none
  };
  /// Replaces one that is under way. stable_step() ends it.
  void begin(Aim aim);
  bool is_under_way() const { return is_searching_ || is_bounding_; }
  /// A portion of the work, in the present state: a directional derivative for the search, or the
  /// bounds of a 64th of the vertices, each about as much as three evaluations of the forces. The
  /// limits when all is done, after 5 to 130 calls, else none. Vertices that changed in the
  /// meantime are among those of bounds_of_changes() as well. Throws NoStepBound.
  std::optional<Found> advance(double time);

  void state(Archive& archive);

 private:
  void before(const ComingOperation&) override { search_.complete(); }
  void follow(const CellComplex& complex, const TopologyChange& change) override;
  bool bound_next_vertices(double time);

  Body& body_;
  StepSearch search_;
  bool is_searching_ = false, is_bounding_ = false;
  Found found_{};
  Index next_vertex_ = 0;
  ChangedVertices changed_;  ///< since bounds_of_changes()
  VertexSelection selection_;
};

}  // namespace suture
