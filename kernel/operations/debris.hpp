// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/build/built_scene.hpp"
#include "kernel/operations/removed_matter.hpp"

namespace suture {

// Islands that are too small to be computed
// =========================================
//
//   +-----+-----+                 A cube of which a thousandth is material weighs a thousandth of
//   |     |    /|  <- an island   its neighbours, and what touches it weighs as much as before. It
//   |     |   / |     of 0.3 %    is pressed flat within a step, and the run ends. Such islands are
//   +-----+--+--+                 removed as soon as an operation has made them, and their volume,
//         cuts                    mass, momentum and energy are booked.
//
// An island that the mesh had from the start is no debris: no operation has made it.

class Debris {
 public:
  /// Build it before any operation. O(elements) if the scene removes debris or cuts along blades.
  Debris(const Scene& scene, BuiltScene& built);

  bool is_removed() const { return removes_; }
  /// Islands of less volume are debris, m^3.
  double limit() const { return limit_; }
  /// The volumes of the body and of a typical element at the start, m^3; 0 in scenes that neither
  /// remove debris nor cut along blades.
  double volume_at_start() const { return volume_at_start_; }
  double typical_volume() const { return typical_volume_; }

  /// The elements of all debris, ascending. O(islands), and the elements of the small ones.
  std::vector<Index> find() const;
  /// What whole islands hold. Evaluates their stored energy.
  RemovedMatter matter(std::span<const Index> elements) const;
  /// The volume of an island, m^3; infinite if it is at least `limit`.
  double volume_below(Index island, double limit, std::vector<Index>& elements) const;

 private:
  BuiltScene& built_;
  bool removes_;
  double limit_ = 0, typical_volume_ = 0, volume_at_start_ = 0;
  std::vector<Index> given_;  ///< small islands of the mesh, ascending
};

/// The elements of all islands that have less volume at rest, ascending. O(islands), and the
/// elements of the small ones.
std::vector<Index> elements_of_small_islands(BuiltScene& built, double volume);

}  // namespace suture
