// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/dynamics/time_ramp.hpp"

namespace suture {

/// Where a constrained vertex of rest position X is at time t, with s = ramp(t):
///   x = c + R(axis, s angle) (X - c) + s translation
/// Nothing moves: x = X, a fixed vertex.
struct PrescribedMotion {
  Vec3 translation{};  ///< m, at the end of the ramp
  Vec3 axis{};         ///< any length but 0 if angle != 0
  Vec3 centre{};       ///< c, m
  double angle = 0;    ///< rad, at the end of the ramp
  TimeRamp ramp;
  bool moves() const { return angle != 0 || translation != Vec3{}; }
};

/// Vertices whose position is given. They cost a pass over a list; vertices that
/// are free cost nothing.
class Constraints {
 public:
  /// Gives `components` (bits 1 x, 2 y, 4 z) of `vertices`; where groups overlap,
  /// the one added last wins. Marks them in the column `fixed`.
  void add(std::span<const Index> vertices, std::uint8_t components, const PrescribedMotion& motion,
           Attributes& attributes);

  /// Position and velocity (its derivative) of all constrained components at
  /// `time`, of vertices begin .. end-1. O(constrained among them + groups log vertices).
  void apply(Attributes& attributes, double time, Index begin = 0, Index end = none) const;

  /// The parts of a split vertex are constrained alike. Of vertices that became one
  /// each hands on what holds it, but components that are held already keep the motion
  /// of the vertex that stays. Removed vertices are forgotten. O(change), and O(group)
  /// where a group gains or loses a vertex; the first call O(vertices).
  void update(const TopologyChange& change, Attributes& attributes);

  /// Vertices all of whose components are held at rest, and never move. One per
  /// vertex of the complex.
  std::vector<bool> still(Index vertex_count) const;

  bool empty() const { return groups_.empty(); }
  Index vertex_count() const;    ///< constrained, counted once per group
  double settled_after() const;  ///< time when the last motion ends, s

 private:
  struct Group {
    PrescribedMotion motion;
    std::uint8_t components;
    std::vector<Index> vertices;  ///< ascending
    /// Theirs, one behind the other: every step reads them, and nothing else of the column.
    std::vector<Vec3> rest;
    std::vector<bool> member;  ///< by vertex; filled by the first change
  };
  static void read_rest(Group& group, Attributes& attributes);
  void find_members(Index vertex_count);
  std::uint8_t held(Index vertex) const;
  std::vector<Group> groups_;
};

}  // namespace suture
