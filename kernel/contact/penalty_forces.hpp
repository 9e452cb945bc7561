// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/contact/contact_term.hpp"

namespace suture {

/// Contact with obstacles as springs, without friction, for explicit runs that must keep energy:
///   f = k max(0, -g) n
/// at each vertex of the boundary, with the gap g and the normal n of the obstacle. The stiffness k
/// is a tenth of a bound on that of the body at the vertex, at the start and after operations: with
/// more, the stable step would be shorter by more than 5 %. So a body under a pressure p sinks in
/// by a few elements times p / M, M its P-wave modulus.
///
/// Cost: a pass over the vertices of the boundary in each step.
class PenaltyForces final : public ContactTerm {
 public:
  /// Of the bound on the stiffness of the body.
  static constexpr double stiffening = 0.1;

  PenaltyForces(Contact& contact, Attributes& attributes, ForceTerm& models)
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
};

}  // namespace suture
