// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "kernel/dynamics/motion_path.hpp"
#include "kernel/forces/time_ramp.hpp"
#include "kernel/scene/selection.hpp"

namespace suture {

/// Nodes that are fixed or moved.
struct Constraint {
  std::string name{};  ///< by which an event releases it; may be empty
  Selection where;
  std::uint8_t components = 7;  ///< bits x 1, y 2, z 4; the body finds the others
  // Prescribed motion: zero for a fixed set. x = c + R(angle) (X - c) + translation.
  Vec3 translation{};  ///< m, at the end of the ramp
  Vec3 axis{}, centre{};
  double angle = 0;  ///< rad, at the end of the ramp
  TimeRamp ramp;
  MotionPath path;  ///< instead of translation, angle and ramp, unless it is empty
  bool moves = false;

  /// When its motion ends, s.
  double end() const { return path.empty() ? ramp.to : path.stations.back().at; }
};

}  // namespace suture
