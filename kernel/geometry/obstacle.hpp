// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "kernel/geometry/rotation.hpp"
#include "kernel/geometry/shape.hpp"

namespace suture {

class Archive;

/// Where a rigid body is: x = c + R (X - c) + t for its points X as given in the scene.
struct Pose {
  Rotation turn = no_rotation;  ///< R
  Vec3 centre{}, translation{};

  Vec3 place(const Vec3& given) const;
  Vec3 given(const Vec3& place) const;  ///< the inverse of place()
  Vec3 direction(const Vec3& given) const;
  bool is_as_given() const { return turn == no_rotation && translation == Vec3{}; }
};

/// R as a vector (rotation.hpp), at most pi long.
inline Vec3 rotation_vector(const Pose& pose) { return rotation_between(no_rotation, pose.turn); }

/// Where a rigid body is to be, relative to where the scene gives it. What is left out stays as it
/// is.
struct PoseTarget {
  double at = 0;                      ///< s
  std::optional<Vec3> translation{};  ///< m
  std::optional<Vec3> rotation{};     ///< by its length, rad, about its direction
};

/// The motion of a rigid body: linear in time between stations, and at rest before the first and
/// after the last. R is the rotation by the angle about `axis`, after `turn`.
struct RigidPath {
  struct Station {
    double at = 0;       ///< s
    Vec3 translation{};  ///< m
    double angle = 0;    ///< rad, about `axis` through `centre`
  };
  std::vector<Station> stations;  ///< by time; empty: it stays as given
  Vec3 axis{0, 0, 1}, centre{};
  Rotation turn = no_rotation;

  bool moves() const { return stations.size() > 1; }
  Pose pose(double time) const;
  /// A bound on the speed of its points within `reach` of `centre` from `time` on, m/s.
  double top_speed(double time, double reach) const;
  double last_change() const { return moves() ? stations.back().at : 0; }
  /// The time of the first station after `time`, s; infinite without one.
  double next_change(double time) const;
  /// From the pose at `time` to the target, at a constant velocity and, the short way round, at a
  /// constant spin. `target.at` must be later than `time`.
  RigidPath steered(double time, const PoseTarget& target) const;
  void state(Archive& archive);
};

/// How a tool hangs on the hand that moves it (tool.hpp).
struct Coupling {
  double mass = 0, stiffness = 0, damping = 0;                     ///< kg, N/m, N s/m
  double inertia = 0, turning_stiffness = 0, turning_damping = 0;  ///< kg m^2, N m/rad, N m s/rad
};

/// A rigid solid that no body enters.
struct Obstacle {
  std::string name;
  std::string path;  ///< JSON path, for messages
  Shape shape;
  RigidPath motion{};
  double friction = 0;    ///< Coulomb's coefficient
  bool push_out = false;  ///< moves what is inside at the start out slowly, instead of an error
  std::optional<Coupling> coupling{};  ///< compliant: `motion` is that of the hand
  bool pushes = true;  ///< false: it carries a blade along which elements are divided
  /// The largest distance of a point from the centre of the motion, m.
  double reach() const;
};

}  // namespace suture
