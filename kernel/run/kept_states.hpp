// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "kernel/base/archive.hpp"

namespace suture {

/// Two states of a run, 32 steps apart, to go back to when a step turns out to be wrong: the
/// older one lies so far back that an instability which is seen now had not begun there.
/// 0.2 % of a step; 96 B per vertex.
class KeptStates {
 public:
  struct State {
    std::uint64_t step = 0;
    double time = 0;  ///< s
    StateBuffer buffer;
    void state(Archive& archive);
  };

  /// Before step `step`, with everything done that is due at its beginning. True if `run` was
  /// kept, and the older state is another. `sooner`: do not wait for 32 steps.
  template <class Run>
  bool look(std::uint64_t step, double time, Run& run, bool sooner) {
    if (step < due_ && !(sooner && count_ > 0)) return false;
    State& state = states_[count_ < 2 ? (older_ + count_) % 2 : older_];
    state.step = step;
    state.time = time;
    state.buffer.save(run);
    kept(step);
    return true;
  }
  /// An operation was made, which nothing goes back behind. The next state is kept at once, or
  /// four steps after the last one, so that a blade that cuts in every step costs 1 % here.
  void forget(std::uint64_t step);
  bool empty() const { return count_ == 0; }
  /// The older state; it is the only one from now on.
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
