// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/contact/contact_term.hpp"

// Springs that keep energy
// ========================
//
//   f |            /      The stiffness grows from zero over the first 0.1 of an edge, to 0.04 of
//     |           /       the body's own bound at the vertex. The energy of a soft touch hardly
//     |         ./        depends on where in a step the vertex meets the surface.
//     |_____..-'
//     +-----+-----> d
//     0     e
//
// Measured: blocks of 2 to 4 elements fall onto a floor, E from 1e5 to 1e7 Pa, from 0.1 to 4 edges
// high, 162 jittered cases at the default safety. After ten bounces their energy is that of the
// fall to 1.5 %; the root mean square is 0.3 %. With a stiffness that starts at once, at 0.1 of
// the bound, it was 9 %, and 4 % at a safety of 0.4. A body of a single layer of elements has an
// error of up to 5 %, most of it in its own vibration, which the step resolves badly.

namespace suture {

/// Contact with obstacles as springs, without friction, for explicit runs that must keep energy:
///   f = k d^2 / (2 e) n   to the depth d = e,   f = k (d - e / 2) n   beyond it,
/// at each vertex of the boundary, with the depth d = -g of its gap g, the normal n of the obstacle
/// and the onset e. A stiffness that jumped at the surface would change the energy by up to
/// k (v dt)^2 / 8 at each touch, by where in a step it falls. The stiffness k is 0.04 of a bound on
/// that of the body at the vertex, at the start and after operations: the error grows with it, too.
/// So a body under a pressure p sinks in by e / 2 and 7 elements times p / M, M its P-wave modulus.
///
/// Cost: a pass over the vertices of the boundary in each step.
class PenaltyForces final : public ContactTerm, public BoundedTerm {
 public:
  /// A part of the bound on the stiffness of the body.
  static constexpr double stiffening = 0.04;
  /// A part of a typical edge of the surface.
  static constexpr double onset = 0.1;

  PenaltyForces(Contact& contact, Attributes& attributes, BoundedTerm& models)
      : ContactTerm(contact, attributes, models, stiffening) {}

  void add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) override;
  void add_tangent(const double* d, double dx, double dv, const TangentTime& at,
                   double* out) override;
  void add_bounds(double time, const AddBounds& sums) override;
  /// On the body: what is stored while it touches is missing from it.
  double work() const override { return work_; }
  void forget_last() override { last_.clear(); }
  void restart() override;

  void follow(const CellComplex& complex, const TopologyChange& change) override;
  void state(Archive& archive) override;

 private:
  using Forces = std::vector<Contact::Force>;
  Forces forces_at(double time) override;
  template <class Visit>
  void for_each_push(double time, Visit visit);
  double work_since_last(const Forces& forces) const;

  double work_ = 0;
  // At the end of the last step, for its work. Rows of 4.
  Forces forces_;
  std::vector<double> last_;  ///< positions; empty: no step yet
  double last_time_ = 0;
};

}  // namespace suture
