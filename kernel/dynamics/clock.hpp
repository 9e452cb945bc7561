// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "kernel/base/archive.hpp"

namespace suture {

/// The time of a run. With a fixed dt, t = step * dt (not a sum, which would drift), and scheduled
/// actions happen at the step nearest to their time. With an automatic dt, the interval to the next
/// stop (a frame, an event, the end of a ramp, a corner of a path) is divided into equal steps no
/// longer than the stable step, so stops are hit exactly.
class Clock {
 public:
  /// `stops`: times that an automatic dt must hit, unordered. `period` > 0 adds its multiples.
  /// `end`: last stop, or none for a run until rest.
  Clock(std::optional<double> fixed_dt, std::vector<double> stops, double period,
        std::optional<double> end);

  std::uint64_t step() const { return step_; }
  double time() const { return time_; }
  /// True if `t` is not later than now, to within half a fixed step (or half a part of a divided
  /// one), otherwise to within rounding.
  bool reached(double t) const;
  /// True if `t` is earlier than now by more than the tolerance of reached().
  bool passed(double t) const;
  bool finished() const { return end_ && reached(*end_); }

  /// The length of the next step. `stable` bounds an automatic dt, and `stop` is one more stop,
  /// after reached_until(); pass the same values until they change. O(1) except at stops.
  double next_dt(double stable, double stop = std::numeric_limits<double>::infinity());
  /// With an automatic dt, stops up to this time have been reached: now, to within rounding.
  double reached_until() const;
  /// Divides steps of a fixed dt in two `halvings` times, from the next step on (or, if they become
  /// longer, from the next whole step on).
  void divide(unsigned halvings);
  /// Call after the step of next_dt().
  void advance();
  /// Undoes advance(), at most once per call.
  void undo_advance();
  void state(Archive& archive);

 private:
  double next_stop() const;
  double tolerance() const;

  std::optional<double> fixed_dt_, end_;
  std::vector<double> stops_;  // ascending
  double period_;
  std::uint64_t step_ = 0;
  double time_ = 0;
  // The current interval of an automatic dt: start_ + (done_/steps_) length_.
  double start_ = 0, length_ = 0, stable_ = 0;
  double stop_ = std::numeric_limits<double>::infinity();  ///< besides stops_
  std::uint64_t steps_ = 0, done_ = 0;
  // Fixed dt: whole steps made, and parts_made_ out of parts_ of the next one.
  std::uint64_t whole_ = 0, parts_ = 1, parts_made_ = 0, wanted_parts_ = 1;
  struct Before {
    double time;
    std::uint64_t done, whole, parts, parts_made;
  };
  Before before_{};  ///< the state before the last advance()
};

}  // namespace suture
