// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "kernel/attributes/attributes.hpp"
#include "kernel/base/archive.hpp"
#include "kernel/dynamics/motion_path.hpp"
#include "kernel/forces/loops/loops.hpp"
#include "kernel/forces/time_ramp.hpp"
#include "kernel/geometry/obstacle.hpp"

namespace suture {

/// The position at time t of a constrained vertex with rest position X, with s = ramp(t):
///   x = c + R(axis, s angle) (X - c) + s translation
/// or with translation and angle of a path at time t. Without motion, x = X: a fixed vertex. Where
/// an obstacle carries vertices, X - c is first turned by `turn`.
struct PrescribedMotion {
  Vec3 translation{};  ///< m, at the end of the ramp
  Vec3 axis{};         ///< any length but 0 if the motion turns
  Vec3 centre{};       ///< c, m
  double angle = 0;    ///< rad, at the end of the ramp
  TimeRamp ramp;
  MotionPath path;  ///< instead of translation, angle and ramp, unless it is empty
  Rotation turn = no_rotation;
  double reach = 0;  ///< m: the farthest that a step may move a vertex; 0: no limit

  bool moves() const {
    return angle != 0 || translation != Vec3{} || !path.empty() || turn != no_rotation;
  }
  Placed at(double time) const;
  double begin() const { return path.empty() ? ramp.from : path.stations.front().at; }  ///< s
  double end() const { return path.empty() ? ramp.to : path.stations.back().at; }       ///< s
  void state(Archive& archive);
};

/// The energy that prescribed motion exchanges in a step with the vertices that it drives, where w-
/// and w+ are their mean velocities in the previous and the next step (dx = h w):
///   work = - sum m a . (h- w- + h+ w+) / 2,   inertia = sum m (w+^2 - w-^2) / 2   J
/// Reactions times displacements equal the sum of the two.
struct DrivenWork {
  double work = 0, inertia = 0;
};

/// An obstacle that carries vertices, by place, and where it is.
struct Carrier {
  std::size_t obstacle = ~std::size_t{0};  ///< or nothing
  Pose pose{};
};

/// Vertices with prescribed positions. They cost a pass over a list; free vertices cost nothing.
class Constraints {
 public:
  /// Constrains `components` (bits 1 x, 2 y, 4 z) of `vertices`; where groups overlap, the last one
  /// added takes precedence. Marks them in the column `fixed`.
  void add(std::span<const Index> vertices, std::uint8_t components, const PrescribedMotion& motion,
           Attributes& attributes, std::string name = {});

  /// Holds `components` of vertices from where they are, x = c + R(X - c) + translation with X
  /// their places now, or their places relative to the carrier. Components that are held already
  /// keep their motion. Returns the number of vertices that it holds.
  Index grasp(std::span<const Index> vertices, std::uint8_t components,
              const PrescribedMotion& motion, Attributes& attributes, const std::string& name,
              const Carrier& carrier = {});
  /// What an obstacle carries moves by this from now on.
  void redirect(std::size_t obstacle, const PrescribedMotion& motion, Attributes& attributes);
  /// What a grasp holds moves by this from now on, from where it is now.
  void redirect(const std::string& grasp, const PrescribedMotion& motion, Attributes& attributes);
  /// Frees the vertices of this name, and returns them, ascending; empty if there are none.
  std::vector<Index> release(const std::string& name, Attributes& attributes);
  /// Those that it holds, ascending, and which of their components.
  struct Held {
    Index vertex;
    std::uint8_t components;
  };
  std::vector<Held> held_by(const std::string& name) const;
  std::vector<std::string> names() const;
  /// Marks what is held in the column `fixed`, which is not part of a checkpoint.
  void mark(Attributes& attributes) const;

  /// False for schemes that find equilibria: prescribed motions have a place at each time and no
  /// velocity, so no force that reads velocities feels how fast time passes.
  void give_velocity(bool gives) { gives_velocity_ = gives; }
  /// Sets position and velocity (its derivative) of all constrained components at `time`, for
  /// vertices begin .. end-1. O(constrained vertices among them + groups log vertices).
  void apply(Attributes& attributes, double time, Index begin = 0, Index end = none) const;

  /// Called around a pass that kicks and drifts vertices begin .. end-1, followed by apply(): fixed
  /// components are excluded from the sums of the pass, and driven components are included with
  /// their actual displacement. before_drift() replaces the forces there. `before` and `now`: h-
  /// and h+ (`before` = 0: that half of the work is already in the ledger).
  void before_drift(Attributes& attributes, const Vec3& gravity, Index begin, Index end);
  DrivenWork after_drift(Attributes& attributes, double before, double now, Index begin, Index end,
                         loops::PassSums& sums);
  /// Called around a pass that only kicks: the same for the past half of the step.
  void before_kick(Attributes& attributes, Index begin, Index end) const;
  DrivenWork after_kick(Attributes& attributes, const Vec3& gravity, double before, Index begin,
                        Index end, loops::PassSums& sums) const;
  /// - sum m a . h- w- / 2: the work of the past step, at forces that no pass has used yet.
  double work_until_now(Attributes& attributes, const Vec3& gravity, double before) const;
  /// sum m v^2 / 2 of the driven components, J.
  double driven_kinetic(Attributes& attributes) const;
  /// sum m w- . w-, J.
  double driven_inertia(Attributes& attributes) const;
  /// What these leave at driven vertices of begin .. end-1 whose pass another process makes: their
  /// positions at `end_time` and their mean velocities.
  void drift(Attributes& attributes, double dt, double end_time, Index begin, Index end);
  /// The first vertex of begin .. end-1 at which a held component of `column` is not finite, or
  /// `none`.
  Index first_not_finite(const Column& column, Index begin, Index end) const;
  void state(Archive& archive);

  /// The parts of a split vertex have the same constraints. A merged vertex inherits the
  /// constraints of all its predecessors; a component that the kept vertex already constrains keeps
  /// its motion. Removed vertices are dropped. O(change), and O(group) where a group gains or loses
  /// a vertex; the first call O(vertices).
  void update(const TopologyChange& change, Attributes& attributes);

  /// For each vertex of the complex, whether all its components are fixed and never move.
  std::vector<bool> always_fixed(Index vertex_count) const;

  /// The longest step from `time` that moves no vertex by more than its `reach`, s; infinite if
  /// nothing moves.
  double longest_step(double time) const;

  /// The times between two at which a motion begins, ends or comes to a station of its path,
  /// ascending: in between, no motion stops.
  std::vector<double> corners(double from, double to) const;
  /// The largest angle by which a motion turns its vertices between two times, rad.
  double largest_turn(double from, double to) const;

  /// Whether all that is held moves with its rest positions: x = X + translation at `time`.
  bool follow_rest(double time) const;

  bool empty() const { return groups_.empty(); }
  bool has_driven() const { return !driven_.empty(); }  ///< a vertex has a prescribed motion
  void mark_driven(std::vector<bool>& marks) const;     ///< by vertex: those that have one
  Index vertex_count() const;                           ///< constrained, counted once per group
  double last_change() const;                           ///< end of the last motion, s

 private:
  struct Group {
    std::string name;  ///< by which it is released; may be empty: never
    std::size_t carrier = Carrier{}.obstacle;
    bool is_grasp = false;  ///< of places during the run, not at rest
    PrescribedMotion motion;
    std::uint8_t components;
    std::vector<Index> vertices;  ///< ascending
    /// Their rest positions, stored contiguously: every step reads them, but not the rest of the
    /// column.
    std::vector<Vec3> rest;
    std::vector<bool> member;  ///< by vertex; filled by the first change
    /// m: the longest path of a vertex over the whole ramp, or at the top speed of a path.
    double path_length = 0;
  };
  /// A constrained vertex, with the components of all groups together.
  struct Constrained {
    Index vertex;
    std::uint8_t components;
  };
  struct Driven : Constrained {
    Vec3 velocity;         ///< w-, m/s
    Vec3 force, position;  ///< m a and x before the pass
  };
  static void read_rest(Group& group, const Column& places);
  static void find_path_length(Group& group);
  static void set_places(Group& group, const std::map<Index, Vec3>& places, Attributes& attributes);
  static Group part_of(const Group& group, std::uint8_t components, std::vector<Index> vertices,
                       const std::map<Index, Vec3>& places, Attributes& attributes);
  void regather(Attributes& attributes, std::span<const Split> splits);
  void gather(Attributes& attributes);
  void find_members(Index vertex_count);
  std::uint8_t constrained_components(Index vertex) const;
  std::vector<Group> groups_;
  std::vector<Constrained> constrained_;  ///< ascending
  std::vector<Driven> driven_;            ///< ascending; vertices of moving groups
  bool gives_velocity_ = true;
};

}  // namespace suture
