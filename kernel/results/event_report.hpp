// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kernel/operations/event_runner.hpp"

namespace suture {

/// Lines for the user about the effects of events. An event that happens once is reported at once.
/// An event that repeats (a moving blade, a tear) is reported at once the first time and whenever
/// it changes the number of islands; what happens in between is gathered into one line:
///   t = 0.102 to 0.3 s: cut 330 faces in 120 steps, 1 island
class EventReport {
 public:
  explicit EventReport(const std::vector<Event>& events);

  /// Records that event `i` had an effect at `time`, after which there are so many islands.
  /// Returns the lines that are due.
  std::vector<std::string> add(std::size_t i, const EventOutcome& outcome, double time,
                               Index islands);
  /// The lines for what is still gathered.
  std::vector<std::string> finish();
  void state(Archive& archive);

 private:
  struct Gathered {
    EventOutcome outcome;
    double first = 0, last = 0;  ///< s
    std::uint64_t steps = 0;     ///< 0: nothing
    bool began = false;          ///< the event has had its first line
  };
  void flush(Gathered& gathered, std::vector<std::string>& lines) const;

  const std::vector<Event>& events_;
  std::vector<Gathered> gathered_;  ///< by event
  Index islands_ = 0;               ///< after the last effect; 0 if there was none
};

/// "t = 0.5 s: cut 25 faces, 2 islands"
std::string event_line(const EventOutcome& outcome, double time, Index islands);

}  // namespace suture
