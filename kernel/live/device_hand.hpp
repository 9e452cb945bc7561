// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "kernel/live/device.hpp"
#include "kernel/run/simulation.hpp"

// A hand and the body that it touches
// ===================================
//
//      device  --- pose --->  hand  --- input --->  run          1 kHz: the thread of the device
//              <-- force ---        <-- force ----               each exchange: that of the run
//                   1 kHz             per exchange
//
// A device moves an obstacle of the scene, or what it has grasped. Where an obstacle is compliant
// (kernel/contact/tool.hpp), the hand feels its spring, and between two exchanges with the run it
// goes on feeling it: the thread of the device adds k times what the hand has moved meanwhile
// (FeltForce). A run that is slower than the hand thus stays soft but does not lag behind.
//
// A pose becomes an input of the run, which is recorded. Nothing else of the device acts on it.

namespace suture {

/// Edges per step: what a hand holds moves no faster. Grasped nodes would tear a front of large
/// strains through the body, and invert elements; explicit steps are about as long as a wave takes
/// to cross an edge. Tools would shorten an automatic dt.
constexpr double hand_reach = 0.02;

/// What a device holds in a run.
class DeviceHand {
 public:
  /// `obstacle`: the one that it moves; "": the first compliant one, or, if there is none, what is
  /// at a place that begins in the middle of the body and that button 0 grasps. Throws InputError
  /// if the scene has no obstacle of that name. `edge`: the length of an element's edges, m.
  DeviceHand(Simulation& simulation, const std::string& obstacle, double edge);

  /// Where the hand is without an obstacle, and from where it leads what it holds.
  struct Cursor {
    Vec3 place{};                ///< m in the scene
    std::optional<Vec3> grip{};  ///< from held_place() to it
  };
  const Cursor& cursor() const { return cursor_; }
  /// For a run that goes back to a state: the hand is there again, with what it held.
  void return_to(const Cursor& cursor) { cursor_ = cursor; }

  /// From now on the hand follows the motion of the device from `pose`. Call before input().
  void engage(const suture_device_pose& pose);
  /// The input (apply_input()) by which the hand gets to a pose during `steps` steps of length dt
  /// (s), or as far as it may go; "" if it is there.
  std::string input(const suture_device_pose& pose, double steps, double dt);
  /// What the device is to feel now, at the pose of input(). For what is grasped, costs the forces
  /// of the next step, which does not compute them again.
  FeltForce force() const;
  /// Where the hand is in the scene, m.
  Vec3 place() const;
  /// How it is turned: the obstacle since the scene began, or the device; vector, rad.
  Vec3 rotation() const;
  /// "obstacle 'knife'", or "what button 0 grasps".
  std::string holds() const;

 private:
  std::string steered(const suture_device_pose& pose, double steps, double dt) const;
  std::string grasped(const suture_device_pose& pose, double steps, double dt);
  /// The mean place of the nodes that are held, m in the scene; none if there are none.
  std::optional<Vec3> held_place() const;

  Simulation& simulation_;
  std::optional<std::size_t> obstacle_;
  double edge_;
  suture_device_pose engaged_{}, pose_{};
  Pose base_;  ///< of the obstacle when engaged
  Cursor cursor_;
  Vec3 engaged_cursor_{};
};

}  // namespace suture
