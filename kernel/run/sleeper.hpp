// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/scene/built_scene.hpp"

namespace suture {

/// Puts islands to sleep that have come to rest (solver option "sleep"): islands whose nodes all
/// stayed below an acceleration and a velocity in four consecutive checks, 64 steps apart, after
/// the last ramp and motion. A sleeping island is frozen and costs nothing until an operation wakes
/// all islands.
///
/// Error: with acceleration a and velocity v when an island fell asleep, the motion omitted in a
/// time T is at most v T + a T^2 / 2 (put_to_sleep() also gives a bound that does not grow with T).
class Sleeper : private Follower {
 public:
  Sleeper(const SolverOptions& options, BuiltScene& built);

  bool is_enabled() const { return acceleration_ > 0; }
  /// Call after every step. Returns the number of islands that fell asleep now. A check costs a
  /// pass over the awake elements, every 64 steps.
  Index check(std::uint64_t step);
  /// The number of sleeping islands.
  Index sleeping() const;
  void state(Archive& archive);

 private:
  /// Dynamics has woken all islands.
  void follow(const CellComplex& complex, const TopologyChange& change) override;
  bool is_still(std::span<const Index> elements) const;

  BuiltScene& built_;
  double acceleration_, velocity_;      ///< m/s^2, m/s
  std::vector<unsigned> still_checks_;  ///< by island
};

}  // namespace suture
