// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/build/built_scene.hpp"

// Sleep and contact
// =================
//
//   awake block           it pushes, or is about to: the whole stack wakes,
//       |  v              one step before the impact
//       v
//   [ sleeper ]
//   [ sleeper ]           pressed together: they fell asleep together
//   ===========
//
// Islands that press on each other fall asleep together, so that no support moves under a sleeper.
// An awake piece meets a sleeper as something held. The push counts in this step, or in the next
// one if the gap closes in it. An impact therefore wakes a stack one step before it happens, and
// no momentum is lost. Pairs of two sleepers are not in the list of near pairs. The forces between
// sleepers stay, so tables show them, and the sweeps after waking begin with them.
//
// Four blocks of 250 elements, packed face to face, cost 0.7 ms per step awake and 0.011 ms
// asleep.

namespace suture {

/// Puts islands to sleep that have come to rest (solver option "sleep"): islands whose nodes all
/// stayed below an acceleration and a velocity in four consecutive checks, 64 steps apart, after
/// the last ramp and motion of loads and constraints. Islands that press on each other fall asleep
/// together, and none does within an edge of an obstacle that moves or is compliant. A sleeping
/// island is frozen and costs nothing until an operation wakes all islands.
///
/// With contact, a sleeper and all sleepers that touch it, or those, wake when
///  - an obstacle that moves or is compliant comes within an edge of it;
///  - an awake island pushes one of its nodes, or is about to, so that it would accelerate by more
///    than the threshold of sleep, m/s^2: what a push below it would do is within the error of
///    sleep. Until then the sleeper is held.
/// The forces between sleepers, and of obstacles on them, stay as they were.
///
/// Error: with acceleration a and velocity v when an island fell asleep, the motion omitted in a
/// time T is at most v T + a T^2 / 2 (put_to_sleep() also gives a bound that does not grow with T).
class Sleeper : private Follower {
 public:
  Sleeper(const SolverOptions& options, BuiltScene& built);

  bool is_enabled() const { return acceleration_ > 0; }
  /// Call after every step. True if some island fell asleep or woke. A check costs a pass over the
  /// awake elements, every 64 steps; and while something sleeps, a pass over the boundary in every
  /// step in which an obstacle moves.
  bool check(std::uint64_t step);
  /// Call before motion or forces are changed from outside.
  void wake_all();
  /// check() does this; call it when an obstacle begins to move from outside. True if some woke.
  bool wake_disturbed();
  /// The number of sleeping islands.
  Index sleeping() const;
  void state(Archive& archive);

 private:
  /// Dynamics has woken all islands.
  void follow(const CellComplex& complex, const TopologyChange& change) override;
  bool is_still(std::span<const Index> elements) const;
  std::vector<bool> disturbed();
  void wake(const std::vector<bool>& islands);
  bool put_still_to_sleep();
  void count_still_checks(const std::vector<std::vector<Index>>& elements);
  std::vector<Index> groups() const;
  Index island_of(Index vertex) const;
  double last_change() const;

  BuiltScene& built_;
  double acceleration_, velocity_;      ///< m/s^2, m/s
  std::vector<unsigned> still_checks_;  ///< by island
  std::vector<std::uint8_t> asleep_;    ///< by island
};

}  // namespace suture
