// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "kernel/base/archive.hpp"
#include "kernel/base/types.hpp"

namespace suture {

/// Where a prescribed motion has taken its vertices, and how fast it moves them.
struct Placed {
  Vec3 translation{};  ///< m
  double angle = 0;    ///< rad
  Vec3 velocity{};     ///< m/s, of the translation
  double spin = 0;     ///< rad/s
};

/// A motion through stations, at rest before the first and after the last. Between two stations,
/// with s from 0 to 1 and h the time between them,
///   linear: u = u0 + s (u1 - u0)
///   else:   u = u0 + (3 s^2 - 2 s^3) (u1 - u0) + h (s (1 - s)^2 u0' - s^2 (1 - s) u1'),
/// the cubic with the slopes u' at its ends: 0 for motion that stops at each station.
struct MotionPath {
  struct Station {
    double at = 0;                  ///< s
    std::array<double, 4> place{};  ///< translation along x, y, z in m, and angle in rad
    std::array<double, 4> slope{};  ///< its derivative, 1/s; not used where motion is linear
  };
  std::vector<Station> stations;  ///< by time
  bool is_linear = true;

  bool empty() const { return stations.empty(); }
  bool turns() const;
  bool has_slopes() const;  ///< after make_monotone()
  /// O(log stations).
  Placed at(double time) const;
  /// Times at which a step should end: where the motion begins and ends, and where it is linear, at
  /// every station, because velocities jump there.
  std::vector<double> corners() const;
  /// The highest speed of a point at this distance from the axis of rotation, or more, m/s.
  double top_speed(double radius) const;
  /// Gives each station the slope of the monotone cubic of Fritsch and Carlson (SIAM J. Numer.
  /// Anal. 17, 1980), which does not overshoot. Needs four stations.
  void make_monotone();
  void state(Archive& archive);
};

}  // namespace suture
