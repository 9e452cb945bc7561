// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/forces/gravity.hpp"

#include "kernel/forces/sum_of_blocks.hpp"

namespace suture {

Vec3 Gravity::acceleration(double time) const {
  const double r = ramp_.value(time);
  return {r * value_[0], r * value_[1], r * value_[2]};
}

void Gravity::add_forces_in_step(const StepTimes& step, const LiveMask&, double*) {
  // While the ramp rises from here to the next state, or rose from the last one.
  const double now = ramp_.value(step.time), next = ramp_.value(step.time + 2 * step.dt);
  if (now != next || now != last_ramp_) book(step.time);
}

// The trapezoid between two bookings is exact where the ramp does not change between them:
//   W += (r + r') / 2 (sum m g . x' - sum m g . x)
void Gravity::book(double time) {
  if (value_ == Vec3{}) return;
  const PartialRows::OwnIsEnough own(attributes_.partial_rows());
  const double moment = sum_of_blocks(share_, attributes_.vertex_count(), BodyShare::block,
                                      [&](Index first, Index end) {
                                        double sum = 0;
                                        for (Index v = first; v < end; ++v) sum += moment_of(v);
                                        return sum;
                                      });
  const double ramp = ramp_.value(time);
  if (is_booked_) work_ += (last_ramp_ + ramp) / 2 * (moment - moment_);
  moment_ = moment;
  last_ramp_ = ramp;
  is_booked_ = true;
}

double Gravity::booked_at(std::span<const Index> vertices) const {
  double moment = 0;
  for (const Index v : vertices) moment += moment_of(v);
  return moment;
}

double Gravity::moment_of(Index vertex) const {
  const double* x = attributes_.position().rows() + std::size_t{vertex} * 4;
  return attributes_.mass().rows()[vertex] *
         (value_[0] * x[0] + value_[1] * x[1] + value_[2] * x[2]);
}

double Gravity::potential(double time) {
  const double* rest = attributes_.rest().rows();
  const double* position = attributes_.position().rows();
  const double* mass = attributes_.mass().rows();
  double sum = 0;
  for (Index v = 0; v < attributes_.vertex_count(); ++v) {
    const std::size_t at = std::size_t{v} * 4;
    double work = 0;
    for (std::size_t c = 0; c < 3; ++c) work += value_[c] * (position[at + c] - rest[at + c]);
    sum -= mass[v] * work;
  }
  return ramp_.value(time) * sum;
}

void Gravity::restart() {
  work_ = moment_ = last_ramp_ = 0;
  is_booked_ = false;
}

void Gravity::state(Archive& archive) {
  if (archive.has_cells()) archive("value", value_);
  archive("work", work_);
  archive("moment", moment_);
  archive("last ramp", last_ramp_);
  archive("is booked", is_booked_);
}

}  // namespace suture
