// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>

#include "kernel/base/archive.hpp"

// Why a search for rest ends at rounding
// ======================================
//
// Positions are rounded by eps |x| in each step. Multiplied by the stiffness m (2/dt)^2 this is a
// force, and a damped mode retains 1/(alpha dt) of it. Below that level the search would never
// end. At that level, noise dominates the Rayleigh quotient between two checks, from which the
// damping is chosen. At nu = 0.499 and E = 10 GPa the quotient rose 18-fold, and the damping with
// it. The slow modes then crept: 10x2x2 elements took 31,420 steps instead of 12,260 at E = 400
// kPa, and at 100 GPa more than 400,000. Three rules follow.
//
// - The quotient is used only while -dx.df is above 100 times the rounding energy of a step.
// - The length of a window follows from the observed frequency and the damping. A body that the
//   user damps lightly gets the time that it needs (0.05/s on the paper's beam: 161,000 steps).
// - At the level of rounding one window without progress is enough. The damping is then raised to
//   alpha dt = 1 in stages, which reduces the reachable residual 8 to 50 times, often below the
//   tolerance.

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
