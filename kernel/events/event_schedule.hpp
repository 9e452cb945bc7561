// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/dynamics/clock.hpp"
#include "kernel/scene/built_scene.hpp"

namespace suture {

/// Says which events are due at a step: once at their time, every so many steps,
/// once a condition holds, and a moving blade at every step of its way. Conditions
/// look at nodes that were chosen at the start; a cut leaves the choice with one of
/// the parts, a removed node drops out.
class EventSchedule {
 public:
  /// Throws InputError for a condition whose selection selects nothing.
  EventSchedule(const std::vector<Event>& events, BuiltScene& built);

  /// Positions in `events` of what is due now, ascending; each only once per step.
  /// O(events that are not timed); a condition costs a pass over its nodes.
  std::vector<std::size_t> due(const Clock& clock);

  /// What was due so far.
  void state(Archive& archive);

  /// The last time at which something is known to be due, s: before it a body is not
  /// at rest.
  double settled_after() const;

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
