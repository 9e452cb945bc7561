// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/base/archive.hpp"
#include "kernel/forces/loops/loops.hpp"
#include "kernel/forces/time_ramp.hpp"

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
  double reach = 0;  ///< m: no step is to move a vertex farther; 0: as far as it likes
  bool moves() const { return angle != 0 || translation != Vec3{}; }
  void state(Archive& archive);
};

/// What prescribed motion exchanges in a step with the vertices it drives, w- and w+ being
/// their mean velocities in the steps before and after (dx = h w):
///   work = - sum m a . (h- w- + h+ w+) / 2,   inertia = sum m (w+^2 - w-^2) / 2   J
/// Reactions times displacements are the sum of both.
struct DrivenWork {
  double work = 0, inertia = 0;
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

  /// Around a pass that kicks and drifts vertices begin .. end-1, with apply() behind it:
  /// what is held takes no part in the sums of the pass, and what is driven takes part with
  /// the way that it is really moved. before_drift() replaces the forces there. `before` and
  /// `now`: h- and h+ (`before` 0: that half of the work is in the ledger already).
  void before_drift(Attributes& attributes, const Vec3& gravity, Index begin, Index end);
  DrivenWork after_drift(Attributes& attributes, double before, double now, Index begin, Index end,
                         loops::PassSums& sums);
  /// Around a pass that only kicks: the same for the half of the step that is over.
  void before_kick(Attributes& attributes, Index begin, Index end) const;
  DrivenWork after_kick(Attributes& attributes, const Vec3& gravity, double before, Index begin,
                        Index end, loops::PassSums& sums) const;
  /// - sum m a . h- w- / 2: the work of the step that is over, at forces that no pass has
  /// seen yet.
  double work_until_now(Attributes& attributes, const Vec3& gravity, double before) const;
  /// sum m v^2 / 2 of the components that are driven, J.
  double driven_kinetic(Attributes& attributes) const;
  void state(Archive& archive);

  /// The parts of a split vertex are constrained alike. Of vertices that became one
  /// each hands on what holds it, but components that are held already keep the motion
  /// of the vertex that stays. Removed vertices are forgotten. O(change), and O(group)
  /// where a group gains or loses a vertex; the first call O(vertices).
  void update(const TopologyChange& change, Attributes& attributes);

  /// Vertices all of whose components are held at rest, and never move. One per
  /// vertex of the complex.
  std::vector<bool> still(Index vertex_count) const;

  /// A step from `time` on that moves no vertex by more than its `reach`, s; infinite where
  /// nothing moves.
  double longest_step(double time) const;

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
    double way = 0;            ///< m: the longest path of a vertex over the whole ramp
  };
  /// A vertex that some group holds or moves; the components of all groups together.
  struct Held {
    Index vertex;
    std::uint8_t components;
  };
  struct Driven : Held {
    Vec3 velocity;         ///< w-, m/s
    Vec3 force, position;  ///< m a and x before the pass
  };
  static void read_rest(Group& group, Attributes& attributes);
  void gather(Attributes& attributes);
  void find_members(Index vertex_count);
  std::uint8_t held(Index vertex) const;
  std::vector<Group> groups_;
  std::vector<Held> held_;      ///< ascending
  std::vector<Driven> driven_;  ///< ascending: of groups that move
};

}  // namespace suture
