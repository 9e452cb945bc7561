// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>

#include "kernel/base/archive.hpp"
#include "kernel/live/device_hand.hpp"
#include "kernel/live/hand.hpp"

namespace suture {

/// A state of a run to which it can go back.
struct LiveState {
  std::string name;               ///< that of the action which followed, or a given one
  bool is_before_action = false;  ///< taken back by going here
  double time = 0;                ///< s
  std::uint64_t step = 0;
  std::size_t inputs = 0;  ///< number of recorded ones before it
  std::optional<Hand> hand{};
  std::optional<DeviceHand::Cursor> cursor{};  ///< of a device
  StateTree state{};
  std::uint64_t id = 0;  ///< given by keep(), ascending
};

/// Keeps states in memory, in the order of the run. Beyond half a gigabyte or a hundred states, it
/// drops the oldest. The memory of one that was dropped is kept for the next.
class LiveStates {
 public:
  void keep(LiveState state);
  /// Takes out the state with this id, and drops all that follow it. Throws InputError if there is
  /// none.
  LiveState take(std::uint64_t id);
  /// The same for the last one that is before an action.
  LiveState take_last_action();
  /// Drops the last one, if it is before an action that was refused.
  void drop_last() {
    spare_ = std::move(states_.back().state);
    states_.pop_back();
  }
  /// Drops those of later steps.
  void drop_after(std::uint64_t step) {
    while (!states_.empty() && states_.back().step > step) states_.pop_back();
  }
  void clear() { states_.clear(); }
  /// The memory to save the next state in (save_state()); none is empty.
  StateTree take_spare() { return std::exchange(spare_, {}); }
  bool has_spare() const { return !spare_.groups.empty(); }
  void set_spare(StateTree spare) { spare_ = std::move(spare); }
  /// [{"id", "name", "action", "time", "step"}].
  nlohmann::json list() const;

 private:
  std::deque<LiveState> states_;
  StateTree spare_;
  std::uint64_t last_id_ = 0;
};

}  // namespace suture
