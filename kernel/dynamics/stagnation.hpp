// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>

#include "kernel/base/archive.hpp"

namespace suture {

/// Detects when the residual of a search for rest no longer decreases.
///
/// A mode of frequency w with damping alpha decays at the rate
///   alpha / 2                                     alpha <= 2 w
///   w^2 / (alpha/2 + sqrt(alpha^2/4 - w^2))       above: overdamped
/// (slow_rate()). The slowest mode decides, so the smallest w observed in a window is used. In a
/// window of `window_decays` / rate seconds the residual should decrease by e^-5; half of that
/// counts as progress. Without progress in `patience` consecutive windows the search stagnates. It
/// takes an estimate of the rate that is at least 28 times too high to reach this verdict wrongly.
///
/// A residual that rises for a whole window belongs to a body that leaves a state (buckling): the
/// record restarts, at most `restarts_allowed` times, so that a cycle is not mistaken for this
/// indefinitely.
class Stagnation {
 public:
  static constexpr double window_decays = 5;
  static constexpr unsigned patience = 4;
  static constexpr unsigned restarts_allowed = 64;

  /// Adds a check at `time`, s (of a clock that may be paused), after `step` steps. `distance`:
  /// from rest; 1 counts as rest. `rate`: current estimate of the slowest decay, 1/s; 0: unknown.
  void add(std::uint64_t step, double time, double distance, double rate);

  /// Consecutive windows without progress; 0 as long as the residual decreases.
  unsigned idle_windows() const { return idle_; }
  bool stagnates() const { return idle_ >= patience; }
  std::uint64_t steps_without_progress() const { return last_step_ - best_step_; }
  double best() const { return best_; }  ///< smallest distance of this record
  void restart();
  void state(Archive& archive);

 private:
  void close_window(std::uint64_t step);

  static constexpr double infinite = std::numeric_limits<double>::infinity();
  static constexpr unsigned least_checks = 50;  ///< per window

  double best_ = infinite, window_best_ = infinite;  ///< smallest in the record, and in this window
  double window_begin_ = 0, rate_ = infinite;
  std::uint64_t best_step_ = 0, last_step_ = 0, window_best_step_ = 0;
  unsigned checks_ = 0, idle_ = 0, restarts_ = 0;
};

/// The rate, 1/s, at which a mode of frequency w decays with damping alpha; at least a hundredth of
/// w, to allow for viscous forces of the models.
double slow_rate(double w, double alpha);

}  // namespace suture
