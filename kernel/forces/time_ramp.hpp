// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

namespace suture {

/// 0 until `from`, 1 from `to` on; between them linear, or smooth (3 s^2 - 2 s^3,
/// whose rate begins and ends at zero). from == to: a step.
struct TimeRamp {
  double from = 0, to = 0;  ///< s
  bool smooth = false;

  double value(double time) const {
    if (time >= to) return 1;
    if (time <= from) return 0;
    const double s = (time - from) / (to - from);
    return smooth ? s * s * (3 - 2 * s) : s;
  }
  /// Derivative of value(), 1/s; 0 outside the ramp.
  double rate(double time) const {
    if (time >= to || time <= from) return 0;
    const double s = (time - from) / (to - from);
    return (smooth ? 6 * s * (1 - s) : 1) / (to - from);
  }
};

}  // namespace suture
