// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>

#include "kernel/run/clock.hpp"
#include "kernel/run/event_schedule.hpp"
#include "kernel/run/world.hpp"

namespace suture {

/// Two states of a run, 32 steps apart, to go back to when a step turns out to be wrong: the
/// older one lies so far back that an instability which is seen now had not begun there.
/// 0.2 % of a step; 96 B per vertex.
class KeptStates {
 public:
  struct State {
    std::optional<Clock> clock;
    EventSchedule::Mark schedule;
    Dynamics::Snapshot body;
  };

  /// Before a step, with everything done that is due at its beginning. True if a state was
  /// kept, and the older one is another. `sooner`: do not wait for 32 steps.
  bool look(const Clock& clock, const EventSchedule& schedule, const Dynamics& dynamics,
            bool sooner);
  /// An operation was made, which nothing goes back behind. The next state is kept at once, or
  /// four steps after the last one, so that a blade that cuts in every step costs 1 % here.
  void forget(const Clock& clock);
  bool empty() const { return count_ == 0; }
  /// The older state; it is the only one from now on.
  const State& take_older();
  const State& older() const { return states_[older_]; }

 private:
  static constexpr std::uint64_t steps_between = 32, steps_after_event = 4;
  std::array<State, 2> states_;
  unsigned older_ = 0, count_ = 0;
  std::uint64_t due_ = 0, kept_at_ = 0;
};

}  // namespace suture
