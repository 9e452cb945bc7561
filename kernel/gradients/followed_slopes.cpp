// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/gradients/followed_slopes.hpp"

#include <utility>

#include "kernel/base/message_text.hpp"

namespace suture {

FollowedSlopes::FollowedSlopes(Dynamics& dynamics, std::vector<ParameterDirection> parameters,
                               double tolerance)
    : dynamics_(dynamics),
      parameters_(std::move(parameters)),
      tolerance_(tolerance),
      time_(dynamics.time()),
      step_(dynamics) {
  before_.save(dynamics);
  const std::vector<double> zero(std::size_t{dynamics.body().attributes().vertex_count()} * 3);
  const std::vector<double> no_states(step_.states().size());
  slopes_.assign(parameters_.size(), {{zero, zero, no_states}, zero});
}

void FollowedSlopes::follow() {
  const double time = dynamics_.time();
  if (time == time_) return;
  const Column& position = dynamics_.body().attributes().position();
  const std::vector<double> reached = rows_of(position);
  if (time < time_ || std::size_t{position.size()} * 3 != slopes_[0].reaction.size())
    refuse_run("a step was rejected, or cells changed, before " + time_text(time));
  StateBuffer now;
  now.save(dynamics_);
  try {
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      before_.load(dynamics_);
      const double dt = time - time_;
      step_.forward({time_, time, dt, reached}, parameters_[i], tolerance_, slopes_[i]);
    }
  } catch (...) {
    now.load(dynamics_);
    throw;
  }
  now.load(dynamics_);
  std::swap(before_, now);
  time_ = time;
}

}  // namespace suture
