// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/base/types.hpp"

namespace suture {

/// What the mouse holds: nodes of the body around a place, or an obstacle. It is on its way to
/// where the mouse is.
struct Hand {
  std::string tool;                ///< the obstacle; "": nodes, by a grasp
  Vec3 offset{};                   ///< from the mouse to the translation of a tool, m
  Vec3 from{}, to{};               ///< the way, m in the scene
  double start = 0, duration = 1;  ///< of the way, s

  /// Where it is.
  Vec3 place(double time) const;
  /// The same hand on another way, from where it is at `time`.
  Hand led(const Vec3& target, double time, double in) const;
  /// The input (apply_input()) that sends it on its way.
  std::string input() const;
};

/// The names of the grasps with which the mouse and a device hold nodes.
inline constexpr const char *hand_name = "live-hand", *device_grasp_name = "device-hand";

/// The inputs by which the mouse holds the nodes within a radius, and which release a grasp.
std::string hold_input(const Vec3& at, double radius);
std::string release_input(const std::string& grasp);

}  // namespace suture
