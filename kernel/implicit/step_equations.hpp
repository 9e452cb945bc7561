// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/solvers/tangent_matrix.hpp"

namespace suture {

/// The equations of one implicit step for the positions x at its end, on the free components:
///   f(x, v, time) + m g - m a - alpha m v = 0
///   v = v* + rate (x - x*),   a = acceleration (x - x*)
/// Static equilibrium: rate = acceleration = 0 and v* = 0, so x* is only a prediction. On the way
/// to it (LoadPath), loads and gravity can be a sum of those at several times, and constant forces
/// can be held back.
/// Newmark: x* and v* contain multiples of the acceleration at the start, f / m + g - alpha v.
struct StepEquations {
  double time = 0;                         ///< at the end of the step, s
  double dt = 0;                           ///< s
  double rate = 0;                         ///< 1/s
  double acceleration = 0;                 ///< 1/s^2
  std::vector<double> position, velocity;  ///< x* and v*, 4 numbers per vertex
  bool is_predicted = true;                ///< x* may be nearer to the solution than the start is
  double start_position = 0;               ///< what x* contains of it, s^2
  double start_velocity = 0;               ///< what v* contains of it, s
  std::vector<LoadTime> loads{};    ///< of all terms except the models; empty: those at `time`
  std::vector<double> held_back{};  ///< subtracted, N, 3 numbers per vertex; empty: none
};

}  // namespace suture
