// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/gradients/kept_steps.hpp"

#include <cmath>

#include "kernel/base/error.hpp"
#include "kernel/base/message_text.hpp"

namespace suture {
namespace {

std::vector<double> held_by(Attributes& attributes) {
  std::vector<double> held;
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    held.push_back(attributes.fixed().get(v, 0));
  return held;
}

void add_to(std::vector<double>& sum, const std::vector<double>& part) {
  sum.resize(part.size());
  for (std::size_t i = 0; i < part.size(); ++i) sum[i] += part[i];
}

/// Adds what one moment gives to the derivative by each wanted parameter.
void add_slopes(Body& body, const std::vector<ParameterDirection>& wanted, const Moment& moment,
                const Multipliers& multipliers, std::vector<std::vector<double>>& sums) {
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    ParameterSlopes slopes(body, moment, *wanted[i].instance, wanted[i].name);
    if (wanted[i].weights.empty())
      add_to(sums[i], slopes.each(multipliers));
    else
      add_to(sums[i], {slopes.along(multipliers, wanted[i].weights)});
  }
}

}  // namespace

KeptSteps::KeptSteps(Dynamics& dynamics, StepReplay::Limit limit)
    : dynamics_(dynamics),
      body_(dynamics.body()),
      replay_(dynamics, limit),
      start_(dynamics.time()),
      held_(held_by(body_.attributes())) {
  StepSlopes{dynamics};  // throws what its adjoint would
}

void KeptSteps::keep() {
  const double time = dynamics_.time(), last = count() == 0 ? start_ : replay_.step(count()).end;
  if (time == last || !broken_.empty()) return;
  const double dt = dynamics_.motion().last_step();
  if (time < last)
    broken_ = "a step was rejected, and the run went back to " + time_text(time);
  else if (held_by(body_.attributes()).size() != held_.size())
    broken_ = "a cut has changed the vertices before " + time_text(time) +
              "; take the runs before and after it, of two simulations, as one (gradient([first, "
              "second], ...))";
  else if (held_by(body_.attributes()) != held_)
    broken_ = "constraints hold other vertices from " + time_text(time) + " on";
  else if (dynamics_.motion().is_frozen())
    broken_ = "parts of the body sleep from " + time_text(time) + " on; set /solver/sleep to false";
  else if (!dynamics_.is_static() && count() > 0 &&
           std::abs(dt - replay_.step(1).dt) > same_step * dt)
    broken_ = "its steps differ in length before " + time_text(time) +
              ", as where one was rejected or /solver/dt is \"auto\"; choose a smaller /solver/dt, "
              "of which the end is a multiple";
  if (!broken_.empty()) return;
  replay_.keep({last, time, dt});
  last_ = rows_of(body_.attributes().position());
}

void KeptSteps::require_unchanged() const {
  if (!broken_.empty()) refuse_run(broken_);
  if (count() == 0) refuse_run("no step was made since keep_steps()");
  if (dynamics_.time() != replay_.step(count()).end ||
      rows_of(body_.attributes().position()) != last_)
    refuse_run("the state has changed since its last step; keep the steps after the last change");
}

StateSlope KeptSteps::start_slope(const WantedSlopes& wanted, std::size_t states) const {
  StateSlope slope = wanted.end;
  const std::size_t size = held_.size() * 3;
  for (auto* vector : {&slope.position, &slope.velocity}) vector->resize(size);
  slope.states.resize(states);
  return slope;
}

RunAdjoint KeptSteps::adjoint(const SlopesAt& slopes_at, double tolerance,
                              const WantedSlopes& wanted) {
  require_unchanged();
  StepSlopes slopes(dynamics_);
  RunAdjoint adjoint;
  adjoint.parameters.resize(wanted.parameters.size());
  adjoint.load.resize(held_.size() * 3);
  if (wanted.moments) {
    adjoint.loads.assign(count() + 1, adjoint.load);
    adjoint.motions = adjoint.loads;
  }
  adjoint.start = start_slope(wanted, slopes.states().size());
  std::vector<double> position = last_;
  ObjectiveSlopes objective = slopes_at(count());
  replay_.backward([&](std::size_t number) {
    const StepReplay::Step& step = replay_.step(number);
    const std::vector<double> start = rows_of(body_.attributes().position());
    ObjectiveSlopes next = number > 1 ? slopes_at(number - 1) : ObjectiveSlopes{};
    const auto use = [&](bool is_end, const Moment& moment, const Multipliers& multipliers) {
      add_slopes(body_, wanted.parameters, moment, multipliers, adjoint.parameters);
      add_to(adjoint.load, multipliers.force);
      if (wanted.moments) add_to(adjoint.loads[number - (is_end ? 0 : 1)], multipliers.force);
    };
    slopes.backward({step.start, step.end, step.dt, position, number == 1}, objective, tolerance,
                    adjoint.start, use);
    if (wanted.moments) adjoint.motions[number] = slopes.motion();
    position = start;
    objective = std::move(next);
  });
  adjoint.start_position = std::move(position);
  adjoint.iterations = slopes.iterations();
  return adjoint;
}

}  // namespace suture
