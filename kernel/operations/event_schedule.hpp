// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/build/built_scene.hpp"
#include "kernel/dynamics/clock.hpp"

namespace suture {

/// Determines which events are due at a step: once at their time, every n steps, as soon as a
/// condition holds, or, for a moving blade, at every step of its path. Conditions use nodes
/// selected at the start; after a cut, one of the parts remains selected; a removed node is
/// dropped.
class EventSchedule {
 public:
  /// Throws InputError for a condition with an empty selection.
  EventSchedule(const std::vector<Event>& events, BuiltScene& built);

  /// Positions in `events` of the events that are due now, ascending; each only once per step.
  /// O(events that are not timed); a condition costs a pass over its nodes.
  std::vector<std::size_t> due(const Clock& clock);

  /// An event is not due any more.
  void end(std::size_t event) { states_[event].done = true; }

  /// The events that have been due so far.
  void state(Archive& archive);

  /// The last time at which an event is known to be due, s; a body cannot be at rest before it.
  double last_change() const;

 private:
  bool is_due(std::size_t i, const Clock& clock);
  bool holds(std::size_t i) const;

  const std::vector<Event>& events_;
  BuiltScene& built_;
  struct State {
    bool done = false;
    std::uint64_t last_step = ~std::uint64_t{0};
    std::vector<Index> vertices;  ///< of the condition
  };
  std::vector<State> states_;
  std::size_t next_timed_ = 0;
  std::vector<std::size_t> timed_, others_;
};

}  // namespace suture
