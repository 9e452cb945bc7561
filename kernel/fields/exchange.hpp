// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/forces/dead_loads.hpp"

namespace suture {

/// What leaves a field through films on its surface, in proportion to its values: q = - h u A, with
/// the area lumped at the vertices. What enters, h u_outside A, is a flux. Follows operations as
/// fluxes do.
class Exchange final : public ForceTerm, public TangentTerm, public CellTangentTerm {
 public:
  /// `values`: of the field, by vertex and component.
  Exchange(Attributes& attributes, const Column& values)
      : attributes_(attributes), values_(values), coefficients_(attributes) {}

  /// Coefficients h, as the components of a traction. To be added before the first step.
  DeadLoads& coefficients() { return coefficients_; }
  /// The sums of h A at `time`, in rows of 4; kept for the next call at the same time, as each
  /// iteration of a linear solver makes one. Empty if there are no films.
  const std::vector<double>& rows(double time);

  const char* name() const override { return "exchange"; }
  void add_forces(double time, const LiveMask& live, double* rows) override;
  void add_forces_at(const VertexSelection& selection, std::span<const Index> vertices, double time,
                     std::vector<Vec3>& forces) override;
  bool adds_no_rows() const override { return coefficients_.adds_no_rows(); }
  bool is_stiff() const override { return !adds_no_rows(); }
  void add_tangent(const double* d, double dx, double dv, const TangentTime& at,
                   double* out) override;
  bool add_tangent_in_single(const float* d, double dx, double dv, const TangentTime& at,
                             float* out) override;
  void for_each_tangent(double dx, double dv, const TangentTime& at,
                        const VisitTangents& visit) override;
  void follow(const CellComplex& complex, const TopologyChange& change) override;
  void state(Archive& archive) override;

 private:
  Attributes& attributes_;
  const Column& values_;
  DeadLoads coefficients_;
  std::vector<double> rows_;  ///< at rows_time_; empty: to be found
  double rows_time_ = 0;      ///< s
};

}  // namespace suture
