// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>

#include "kernel/base/archive.hpp"

namespace suture {

/// Whether the residual of a search for rest still falls.
///
/// A mode of frequency w under the damping alpha decays at the rate
///   alpha / 2                                     alpha <= 2 w
///   w^2 / (alpha/2 + sqrt(alpha^2/4 - w^2))       above: overdamped
/// (slow_rate()). The slowest mode decides, so the smallest w that the motion has shown in
/// a window counts. In a window of `window_decays` / rate seconds the residual should fall
/// by e^-5; half of it is progress. Without progress in `patience` windows running the
/// search stagnates: at an estimate of the rate that is 28 times too high, at the earliest.
///
/// A residual that rises for a whole window belongs to a body that leaves a state (it
/// buckles): the record starts again, at most `restarts_allowed` times, so that no cycle is
/// taken for that for ever.
class Stagnation {
 public:
  static constexpr double window_decays = 5;
  static constexpr unsigned patience = 4;
  static constexpr unsigned restarts_allowed = 64;

  /// A check at `time`, s (of a clock that may stand still), after `step` steps. `distance`: from
  /// rest, 1 where it counts as rest. `rate`: of the slowest decay as estimated now, 1/s; 0:
  /// unknown.
  void add(std::uint64_t step, double time, double distance, double rate);

  /// Windows without progress, running; 0 as long as the residual falls.
  unsigned idle_windows() const { return idle_; }
  bool stagnates() const { return idle_ >= patience; }
  std::uint64_t steps_without_progress() const { return last_step_ - best_step_; }
  double best() const { return best_; }  ///< smallest distance of this record
  void restart();
  void state(Archive& archive);

 private:
  void close_window(std::uint64_t step);

  static constexpr double infinite = std::numeric_limits<double>::infinity();
  static constexpr unsigned least_checks = 50;  ///< of a window

  double best_ = infinite, here_ = infinite;  ///< smallest of the record, of this window
  double window_begin_ = 0, rate_ = infinite;
  std::uint64_t best_step_ = 0, last_step_ = 0, here_step_ = 0;
  unsigned checks_ = 0, idle_ = 0, restarts_ = 0;
};

/// Rate, 1/s, at which a mode of frequency w decays under alpha; at least a hundredth of w,
/// for what viscous forces of the models add.
double slow_rate(double w, double alpha);

}  // namespace suture
