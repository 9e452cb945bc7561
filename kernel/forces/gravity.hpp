// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/attributes/attributes.hpp"
#include "kernel/forces/term_capabilities.hpp"
#include "kernel/forces/time_ramp.hpp"

namespace suture {

/// f = m g ramp(t). It is added where velocities are computed and needs no separate pass, except
/// for its work: one pass per check, and one per step during the ramp.
class Gravity final : public ForceTerm, public EnergyTerm, public WorkTerm, public SharedTerm {
 public:
  /// `value` in m/s^2.
  Gravity(Attributes& attributes, const Vec3& value, const TimeRamp& ramp)
      : attributes_(attributes), value_(value), ramp_(ramp) {}

  const Vec3& value() const { return value_; }
  /// Only where the energy may jump (Dynamics::change_forces).
  void set_value(const Vec3& value) { value_ = value; }

  const char* name() const override { return "gravity"; }
  void add_forces(double, const LiveMask&, double*) override {}
  void add_forces_in_step(const StepTimes& step, const LiveMask& live, double* rows) override;
  void add_forces_at(const VertexSelection&, std::span<const Index>, double,
                     std::vector<Vec3>&) override {}
  bool adds_no_rows() const override { return true; }
  void divide_sums(BodyShare& share) override { share_ = &share; }
  Vec3 acceleration(double time) const override;
  double potential(double time) override;
  double work() const override { return work_; }
  void book(double time) override;
  void forget_last() override { is_booked_ = false; }
  double booked_at(std::span<const Index> vertices) const override;
  void shift_booked(double difference) override { moment_ += difference; }
  void restart() override;
  void state(Archive& archive) override;
  double last_change() const override { return ramp_.to; }

 private:
  double moment_of(Index vertex) const;

  Attributes& attributes_;
  BodyShare* share_ = nullptr;
  Vec3 value_;
  TimeRamp ramp_;
  double work_ = 0;
  // sum m g . x and the ramp when the work was last booked.
  double moment_ = 0, last_ramp_ = 0;
  bool is_booked_ = false;
};

}  // namespace suture
