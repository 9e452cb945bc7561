// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/contact/contact_in_progress.hpp"
#include "kernel/contact/last_forces.hpp"
#include "kernel/contact/point_pairs.hpp"
#include "kernel/contact/point_sweeps.hpp"
#include "kernel/contact/surface_points.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/geometry/obstacle.hpp"

namespace suture {

// Sweeps over points
// ==================
//
// Points share vertices, so a push on one moves others. They are pushed one after the other, in
// sweeps of Gauss and Seidel over flat arrays (PointSweeps). Each sweep replaces every push by one
// that obeys the law of contact, given all others; so the result obeys it, wherever the sweeps
// begin.
//
// - They begin with the forces of the last step. A body that rests or slides needs 3 sweeps then;
//   from nothing, 16 sweeps were worse than 2 from there.
// - They end when one changes the impulses by less than 1 % (of their norm by the energy) and no
//   point by more than 1e-4 of an edge, but not before 3: with one, or an end by tolerance alone, a
//   block at rest at 0.98 of the angle of friction creeps. With 3, the iteration goes on from step
//   to step, and its state at rest is that of 64 sweeps.
// - Where the first sweep moves a point by more than 1e-3 of an edge, forces of the last step say
//   little: an impact, a new contact, or a step after an operation. Sweeps then go on until none
//   moves a point by 1e-6 of an edge, or to the 64th.
// - Where points touch triangles, sweeps over all end at 1e-4 of an edge or a tenth of the first
//   change, if that is less; with the rule of obstacles, what lies on a sleeping piece trembles.
// - After 8 sweeps, pushes go on in the direction of the last ones, as conjugate gradients do
//   (Silcowitz, Niebe and Erleben, Vis. Comput. 26 (2010) 893). The last sweep has the last word.
// - Planes and pairs of a point and a triangle have a normal that does not change in the step. What
//   other obstacles push comes after them in each sweep, by the general law.

/// Pushes the points of an embedded surface out of obstacles and each other.
class PointPushes {
 public:
  /// `edge`: the shortest of the elements, m. All outlive this.
  PointPushes(const SurfacePoints& points, Attributes& attributes, std::span<const Obstacle> all,
              ContactInProgress& step, double edge)
      : points_(points), attributes_(attributes), obstacles_(all), step_(step), edge_(edge) {}
  void touch(PointPairs& pairs) { pairs_ = &pairs; }

  void begin(const ContactStep& step);
  /// Call when the next step does not continue the last one.
  void forget_forces() { last_.clear(); }
  /// Call after an operation: points are others.
  void follow() {
    grouped_.clear();
    last_.clear();
  }
  void state(Archive& archive) {
    grouped_.clear();
    archive("last forces", last_);
  }
  /// Call before it is added to those pushed.
  void add(const ContactPoint& point);
  /// Adds the pairs of points and triangles where they were `back` seconds ago (PointPairs::find),
  /// after the points near obstacles.
  void find_pairs(double back);
  void push(double dt);
  /// All is as before the first push() of the step.
  void release();
  /// After the last push(): the next step begins with the forces of this one.
  void keep_forces();

  // By place in pushed:
  ContactPoint point(std::size_t i) const {
    const PointSweeps::Contact& of = sweeps_.contacts[i];
    return {step_.pushed[i].vertex, {of.vertices, of.count}, {of.weights, of.count}};
  }
  Vec3 mass(std::size_t i) const {
    const PointSweeps::Row& mass = sweeps_.contacts[i].mass;
    return {mass[0], mass[1], mass[2]};
  }
  /// That changes the velocity of the point, N s.
  Vec3 impulse(std::size_t i, const Vec3& change) const {
    const PointSweeps::Row& mass = sweeps_.contacts[i].mass;
    return {mass[0] * change[0], mass[1] * change[1], mass[2] * change[2]};
  }
  /// The place in pushed of pair i, and what friction has changed in its velocity, m/s.
  std::size_t place_of_pair(std::size_t i) const { return first_pair_ + i; }
  std::span<const Vec3> friction_of_pairs() const { return pair_tangential_; }

 private:
  /// Points that share vertices, directly or through others: places in order_ and of_groups_.
  /// In this order: planar pairs, planes, what other obstacles push, and other pairs.
  struct Group {
    std::size_t first = 0, planes = 0, others = 0, other_pairs = 0, end = 0;
    std::size_t first_vertex = 0, end_of_vertices = 0;
  };
  struct Kind {
    Index number;
    unsigned rank;  ///< in its group
    bool operator==(const Kind&) const = default;
  };
  static bool has_pairs(const Group& group) {
    return group.planes > group.first || group.end > group.other_pairs;
  }
  bool is_pair(std::size_t i) const { return i >= first_pair_; }
  void fill(std::size_t i, double dt);
  unsigned rank(std::size_t i) const;
  void group_points();
  void sweep_group(const Group& group, bool with_pairs, double dt);
  std::span<const std::uint32_t> order(std::size_t first, std::size_t end) const {
    return std::span(order_).subspan(first, end - first);
  }
  void begin_warm(std::size_t i);
  PointSweeps::Changes sweep(std::span<const std::uint32_t> planes,
                             std::span<const std::uint32_t> others, double dt);
  Vec3 change_of(std::size_t i, double dt);
  void finish(double dt);
  void note_push(std::size_t i);

  const SurfacePoints& points_;
  Attributes& attributes_;
  std::span<const Obstacle> obstacles_;
  ContactInProgress& step_;
  double edge_;
  LastForces last_;
  PointPairs* pairs_ = nullptr;
  PointSweeps sweeps_;                  ///< contacts by place in pushed
  std::size_t first_pair_ = 0;          ///< in pushed: pairs follow what obstacles may push
  std::vector<Vec3> pair_tangential_;   ///< of the changes of pairs, m/s
  std::vector<Vec3> plane_velocities_;  ///< of obstacles that are planes, m/s
  double gain_ = 0;                     ///< of the step, s: impulse = gain * force
  bool is_again_ = false;               ///< points have been pushed in this step
  // The same while the same points are near:
  std::vector<Kind> grouped_;  ///< what is in order_; empty: unknown
  std::vector<Group> groups_;
  std::vector<std::uint32_t> order_;  ///< places in pushed, by group
  std::vector<Index> of_groups_;      ///< vertices, by group
};

}  // namespace suture
