// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/gradients/step_replay.hpp"

#include <algorithm>

namespace suture {
namespace {

/// C(states + repeats, states): the steps that can be visited backward with so many states, the
/// first one included, and so many repetitions of a step; at most `enough`.
std::size_t reach(std::size_t states, std::size_t repeats, std::size_t enough) {
  std::size_t product = 1;
  for (std::size_t i = 1; i <= std::min(states, repeats); ++i) {
    product = product * (std::max(states, repeats) + i) / i;
    if (product >= enough) return enough;
  }
  return product;
}

/// Where the next state is kept of `steps` from a state on, with room for so many more.
std::size_t next_state(std::size_t steps, std::size_t room) {
  if (room == 0) return steps - 1;
  std::size_t repeats = 0;
  while (reach(room + 1, repeats, steps) < steps) ++repeats;
  return std::clamp<std::size_t>(steps - std::min(steps, reach(room, repeats, steps)), 1,
                                 steps - 1);
}

}  // namespace

/// Brings the state back when it ends.
class StepReplay::Return {
 public:
  explicit Return(Dynamics& dynamics) : dynamics_(dynamics) { state_.save(dynamics); }
  ~Return() { state_.load(dynamics_); }
  Return(const Return&) = delete;
  Return& operator=(const Return&) = delete;

 private:
  Dynamics& dynamics_;
  StateBuffer state_;
};

StepReplay::StepReplay(Dynamics& dynamics, Limit limit) : dynamics_(dynamics), limit_(limit) {
  keep_state();
}

std::size_t StepReplay::most() const {
  const std::size_t size = std::max<std::size_t>(kept_.begin()->second.size(), 1);
  return std::max<std::size_t>(2, std::min(limit_.states, limit_.bytes / size));
}

void StepReplay::keep_state() {
  kept_[count()].save(dynamics_);
  const bool is_limited = limit_.states != unlimited || limit_.bytes != unlimited;
  if (!is_limited || kept_.size() <= std::max<std::size_t>(1, most() / 2)) return;
  spacing_ *= 2;
  std::erase_if(kept_, [&](const auto& state) { return state.first % spacing_ != 0; });
}

void StepReplay::keep(const Step& step) {
  steps_.push_back(step);
  if (count() % spacing_ == 0) keep_state();
}

void StepReplay::advance(std::size_t from, std::size_t to) {
  for (std::size_t n = from; n < to; ++n) dynamics_.step(steps_[n].dt, steps_[n].end);
  repeated_ += to - from;
}

/// Goes to the state before a step, and keeps some of those on the way.
void StepReplay::go_before(std::size_t step, States& between) {
  between.erase(between.lower_bound(step), between.end());
  const States& nearest = between.empty() ? kept_ : between;
  const auto last = std::prev(nearest.lower_bound(step));
  std::size_t here = last->first;
  last->second.load(dynamics_);
  while (here + 1 < step) {
    const std::size_t room = most() - std::min(most(), kept_.size() + between.size());
    const std::size_t next = here + next_state(step - here, room);
    advance(here, next);
    here = next;
    if (here + 1 < step) between[here].save(dynamics_);
  }
}

void StepReplay::backward(const Visit& visit) {
  const Return back(dynamics_);
  States between;
  for (std::size_t step = count(); step > 0; --step) {
    go_before(step, between);
    visit(step);
  }
}

}  // namespace suture
