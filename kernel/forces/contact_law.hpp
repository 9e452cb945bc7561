// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "kernel/attributes/live_mask.hpp"
#include "kernel/base/archive.hpp"
#include "kernel/base/box.hpp"
#include "kernel/forces/follower.hpp"
#include "kernel/geometry/obstacle.hpp"

namespace suture {

/// A step as an explicit scheme makes it without contact: v' = decay v + gain a, x' = x + dt v'.
struct ContactStep {
  double time = 0, end = 0, dt = 0;  ///< s
  double decay = 1, gain = 0;        ///< of the kicks still to be made
  /// From one velocity to the next, including kicks already made: impulse = whole_gain * force.
  double whole_decay = 1, whole_gain = 0;
  /// The work of an impulse J in them is J . (v- + v+)/2 times this: their length over whole_gain,
  /// as damping takes a part of the impulse.
  double work_gain = 1;
  Vec3 acceleration{};               ///< uniform, in addition to the forces
  const LiveMask* moving = nullptr;  ///< vertices
};

/// What a body, its steps and its results know of contact: two calls in each explicit step, the
/// contact of the last step, and queries. How it acts is left to the room `contact`: by impulses
/// (Contact), or by a term of the body whose forces it records (MultiplierForces, PenaltyForces).
/// It has more than 25 functions, since it is all that other rooms see of contact: half of them are
/// one-line queries of lengths and of the last step.
class ContactLaw : public Follower {
 public:
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }
  /// From now on an obstacle, or the hand of a compliant one, moves along another path, which
  /// begins where it is. Call between steps.
  void set_path(std::size_t obstacle, RigidPath path) {
    obstacles_[obstacle].motion = std::move(path);
  }
  /// Its forces are a term of the body, which says what they are.
  bool is_term() const { return is_term_; }
  /// The edges of the elements at the boundary, at rest, m.
  double shortest_edge() const { return shortest_edge_; }
  double mean_edge() const { return mean_edge_; }
  /// Around the body at rest, and its diagonal, m.
  const Box& box() const { return box_; }
  double size() const { return size_; }

  // ---- an explicit step ----

  /// Call before the pass that kicks and drifts, which clears the forces: keeps those on the
  /// surface.
  virtual void prepare(const ContactStep& step) = 0;
  /// What MotionSums does not know of a vertex that was pushed: the work rate of its other forces
  /// at its new velocity, W, and twice its kinetic energy, J, less those without contact.
  struct Correction {
    Index vertex;
    double after, inertia;
  };
  /// Call after that pass: pushes them out. Throws nothing; the result is valid until the next
  /// call.
  virtual std::span<const Correction> resolve(const ContactStep& step) = 0;
  virtual void restart() = 0;
  /// True if resolve() reads positions, velocities and kept_forces() at marked vertices only, and
  /// changes no others (ForceTerm::marks_vertices()).
  virtual bool marks_vertices() const = 0;
  /// What prepare() has kept, in rows of 4.
  virtual double* kept_forces() = 0;
  /// O(vertices marked).
  virtual void mark_vertices(std::vector<bool>& marks) const = 0;

  // ---- the last step ----

  /// A vertex that an obstacle or another piece pushed in the last step.
  struct Touch {
    Index vertex;
    Vec3 force;  ///< on the vertex, N, mean of the step
  };
  std::span<const Touch> touches() const { return results_.touches; }
  /// On the obstacles in the last step; torques about PlacedObstacle::centre().
  struct Load {
    Vec3 force{}, torque{};  ///< N, N m
  };
  const std::vector<Load>& loads() const { return results_.loads; }
  /// The work of contact without friction and cutting on the body, and that of friction, which is
  /// negative, J.
  double work() const { return results_.work; }
  double friction_work() const { return results_.friction_work; }
  /// That of the tissue against blades, which is negative, J; none where no blade is resisted.
  std::optional<double> cutting_work() const {
    return cuts_ ? std::optional(results_.cutting_work) : std::nullopt;
  }
  /// The work of both in the last step, J.
  double step_work() const { return results_.step_work; }
  struct Results {
    std::vector<Touch> touches{};
    std::vector<Load> loads{};  ///< by obstacle
    double work = 0, friction_work = 0, cutting_work = 0, step_work = 0;
  };
  /// The power of the forces of the last step at the current velocities, W.
  virtual double power() const = 0;
  /// Two pieces that entered each other in the last step although they touch, because they met too
  /// fast or are pressed together too hard.
  struct Failure {
    std::array<Index, 2> vertices;  ///< one of each
    double depth;                   ///< m
  };
  virtual std::optional<Failure> failure() const = 0;

  // ---- queries ----

  /// Where an obstacle is: by its path at `time`, or a compliant one now.
  virtual Pose pose(std::size_t obstacle, double time) const = 0;
  /// A compliant obstacle; none for others.
  struct ToolState {
    Pose pose;
    Vec3 hand_force, hand_torque;  ///< of the tool on the hand, about the centre, N, N m
  };
  virtual std::optional<ToolState> tool_state(std::size_t obstacle) const = 0;
  /// The distance of each vertex of the boundary from the nearest obstacle at `time`, less the
  /// thickness; NaN for other vertices. m
  virtual std::vector<double> gaps(double time) const = 0;
  /// The vertices of the boundary within a distance (m) of an obstacle and its thickness at `time`,
  /// ascending. O(boundary).
  virtual std::vector<Index> vertices_near(std::size_t obstacle, double time,
                                           double distance) const = 0;
  /// The longest step in which no obstacle moves by more than a tenth of an element, and no pieces
  /// approach each other by more than a twentieth of an edge, s.
  virtual double longest_step(double time) const = 0;
  /// A bound on the speed of the points of an obstacle near the body, m/s.
  virtual double top_speed(const Obstacle& obstacle, double time) const = 0;
  /// When the last obstacle stops, s.
  double last_change() const;
  /// The time of the first station of a path after `time`, s; infinite without one.
  double next_change(double time) const;

  // ---- jumps, sleep and state ----

  /// Call when positions jump: what was on the other side may be meant to be there.
  virtual void forget_sides() = 0;
  /// Call when pieces fell asleep or woke: what sleeps is not pushed, and the forces on it stay.
  virtual void change_sleepers(const LiveMask& moving) = 0;
  /// Call after an edge that tissue resists has divided elements, whose copies begin at `first`.
  /// Edges are numbered in the order of their events.
  virtual void edge_divided(std::size_t edge, Index first) = 0;
  /// Boundary vertices within an edge of an obstacle that moves in the step of length dt from
  /// `time` on, or of a compliant one. O(boundary), if there are such obstacles.
  virtual std::vector<Index> near_moving_obstacles(double time, double dt) const = 0;
  /// visit(vertex, acceleration) for sleepers that pieces push, m/s^2.
  using VisitPushed = std::function<void(Index, double)>;
  virtual void for_each_pushed_sleeper(const VisitPushed& visit) const = 0;
  /// Vertices of two pieces that press on each other, asleep or not.
  using Press = std::array<Index, 2>;
  virtual std::vector<Press> presses() const = 0;
  virtual void state(Archive& archive) = 0;

 protected:
  explicit ContactLaw(std::vector<Obstacle> obstacles) : obstacles_(std::move(obstacles)) {
    results_.loads.resize(obstacles_.size());
  }

  std::vector<Obstacle> obstacles_;
  Box box_ = no_box;
  double shortest_edge_ = 0, mean_edge_ = 0, size_ = 0;  ///< m
  bool is_term_ = false;
  bool cuts_ = false;  ///< tissue resists a blade that an obstacle carries
  Results results_;
};

}  // namespace suture
