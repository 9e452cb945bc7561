// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "kernel/base/archive.hpp"

// Which states are kept
// =====================
//
//   step    0         32         64    alarm      A' has replaced A. The run goes back to B,
//   kept    A         B          A'    |          which is 32 to 64 steps before the alarm.
//                     ^----------------+
//
// The older state precedes the beginning of the instability. After a rollback, dt is halved, the
// stable step is recomputed every 64 steps, and dt is doubled after 512 steps without an alarm.
//
// An operation cannot be undone, so it commits what was recorded. The state right after it is
// kept, at most every four steps. The half step before an operation belongs to the forces before
// it. The vertices that it affects receive the difference, from forces evaluated around them
// alone, so that a cut leaves no jump with either integrator.

namespace suture {

/// Two states of a run, 32 steps apart, for a rollback when a step turns out to be wrong: the older
/// one precedes the start of an instability that is detected now. Costs 0.2 % of a step and 96 B
/// per vertex.
class KeptStates {
 public:
  struct State {
    std::uint64_t step = 0;
    double time = 0;  ///< s
    StateBuffer buffer;
    void state(Archive& archive);
  };

  /// Call before step `step`, after everything due at its start. Returns true if `run` was kept, so
  /// that the older state changed. `sooner`: do not wait for 32 steps.
  template <class Run>
  bool keep_if_due(std::uint64_t step, double time, Run& run, bool sooner) {
    if (step < due_ && !(sooner && count_ > 0)) return false;
    State& state = states_[count_ < 2 ? (older_ + count_) % 2 : older_];
    state.step = step;
    state.time = time;
    state.buffer.save(run);
    kept(step);
    return true;
  }
  /// Call after an operation, which no rollback crosses. The next state is kept at once, but at
  /// least four steps after the last one, so that a blade that cuts in every step costs only 1 %.
  void forget(std::uint64_t step);
  bool empty() const { return count_ == 0; }
  /// Returns the older state, which becomes the only one.
  const State& take_older();
  const State& older() const { return states_[older_]; }
  void state(Archive& archive);

 private:
  static constexpr std::uint64_t steps_between = 32, steps_after_event = 4;
  void kept(std::uint64_t step);
  std::array<State, 2> states_;
  unsigned older_ = 0, count_ = 0;
  std::uint64_t due_ = 0, kept_at_ = 0;
};

}  // namespace suture
