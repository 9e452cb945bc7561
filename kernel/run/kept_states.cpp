// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/kept_states.hpp"

#include <algorithm>

namespace suture {

bool KeptStates::look(const Clock& clock, const EventSchedule& schedule, const Dynamics& dynamics,
                      bool sooner) {
  if (clock.step() < due_ && !(sooner && count_ > 0)) return false;
  const unsigned slot = count_ < 2 ? (older_ + count_) % 2 : older_;
  State& state = states_[slot];
  state.clock = clock;
  state.schedule = schedule.mark();
  dynamics.save(state.body);
  if (count_ == 2) older_ = 1 - older_;
  count_ = count_ < 2 ? count_ + 1 : 2;
  kept_at_ = clock.step();
  due_ = kept_at_ + steps_between;
  return true;
}

void KeptStates::forget(const Clock& clock) {
  count_ = 0;
  due_ = std::max(clock.step(), kept_at_ + steps_after_event);
}

const KeptStates::State& KeptStates::take_older() {
  count_ = 1;
  due_ = states_[older_].clock->step() + steps_between;
  return states_[older_];
}

}  // namespace suture
