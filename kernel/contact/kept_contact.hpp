// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/base/archive.hpp"
#include "kernel/contact/entered_sides.hpp"
#include "kernel/forces/contact_law.hpp"

namespace suture {

/// What later steps need of the contact of earlier ones; checkpoints save it.
struct KeptContact {
  /// The force of an obstacle on a vertex in the last step, N. Those on sleepers stay.
  struct ObstacleForce {
    Index vertex, obstacle;
    Vec3 force;
  };
  /// A vertex of a sleeper, and how it would be accelerated, m/s^2.
  struct PushedSleeper {
    Index vertex;
    double acceleration;
  };

  /// The points of an embedded surface have other numbers after operations.
  void forget_points() {
    pair_presses.clear();
    presses_asleep.clear();
    pushed_sleepers.clear();
    sides.clear();
  }
  /// Those of pairs go to what sleeps.
  void change_sleepers(const LiveMask& moving);
  void state_of_pairs(Archive& archive);

  std::vector<ObstacleForce> obstacle_forces;
  EnteredSides sides;
  double last_dt = 0;        ///< s
  double longest_dt = 0;     ///< of all steps so far, s
  double closing_speed = 0;  ///< of pieces that may meet, at most, after contact, m/s
  /// A vertex of each of two pieces with an embedded surface, in the last step or when both fell
  /// asleep.
  std::vector<ContactLaw::Press> pair_presses, presses_asleep;
  std::vector<PushedSleeper> pushed_sleepers;
};

}  // namespace suture
