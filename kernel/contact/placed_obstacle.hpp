// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/rows.hpp"
#include "kernel/contact/curvature.hpp"
#include "kernel/geometry/obstacle.hpp"

namespace suture {

/// The way of a vertex in a step, which contact changes.
struct VertexPath {
  Vec3 start, end;
  Vec3 change{};       ///< of the velocity, m/s
  unsigned fixed = 0;  ///< bits of components that contact must not change
  double dt = 0;

  void move(const Vec3& by) {
    end = plus(end, scaled(dt, by));
    change = plus(change, by);
  }
  /// The part of a vector in free components.
  Vec3 free_part(Vec3 a) const {
    if (fixed == 0) return a;
    for (std::size_t c = 0; c < 3; ++c)
      if (fixed >> c & 1) a[c] = 0;
    return a;
  }
};

/// What an obstacle did to a vertex: changes of velocity, m/s.
struct Push {
  Vec3 normal{}, tangential{};  ///< of the vertex, if it were free
  Vec3 obstacle_velocity{};     ///< of the point that it touches, mean of the step
  double sliding = 0;           ///< its speed along the surface without friction, m/s
};

/// An obstacle during one step.
class PlacedObstacle {
 public:
  /// `thickness`: how far from the obstacle the surface of the body stays, m.
  PlacedObstacle(const Obstacle& obstacle, double thickness, const Pose& start, const Pose& end);
  /// Along its path, from one time to another.
  PlacedObstacle(const Obstacle& obstacle, double thickness, double start, double end)
      : PlacedObstacle(obstacle, thickness, obstacle.motion.pose(start),
                       obstacle.motion.pose(end)) {}
  void move_end(const Pose& end);
  const Pose& start() const { return start_; }
  const Pose& end() const { return end_; }

  /// False if a place is farther than `margin` from touching at the end of the step.
  bool may_touch(const Vec3& place, double margin) const {
    if (is_half_space_) return dot(minus(place, ball_.centre), normal_) < offset_ + margin;
    const Vec3 away = minus(place, ball_.centre);
    const double reach = ball_.radius + offset_ + margin;
    return dot(away, away) < reach * reach &&
           (!is_triangulated_ || surface_may_touch(place, margin));
  }
  /// False if a place is farther than `margin` from touching at the end of the step and was so on
  /// its way from `from` at the start.
  bool may_meet(const Vec3& from, const Vec3& place, double margin) const {
    if (may_touch(place, margin)) return true;
    const double way = longest_way(from, place);
    return way > long_way_ && may_touch(place, margin + way);
  }
  /// From the surface of the obstacle at the end of the step, less the thickness; negative inside.
  Nearest gap(const Vec3& place) const { return gap(end_, place); }
  /// The same on the side by which a vertex that was at `from` at the start of the step enters it
  /// (swept_gap.hpp), if it moves relative to the obstacle by more than a quarter of its thickness.
  Nearest gap(const Vec3& from, const Vec3& place) const {
    return longest_way(from, place) > long_way_ ? gap_from(start_.given(from), place) : gap(place);
  }
  /// The same for a place in the coordinates of the obstacle as given.
  Nearest gap_from(const Vec3& given, const Vec3& place) const;
  /// Just outside, in these coordinates, where a vertex with such a gap touches it.
  Vec3 given_outside(const Vec3& place, const Nearest& gap, double height) const {
    return end_.given(plus(place, scaled(height - gap.distance, gap.normal)));
  }
  /// A bound on how far a vertex moves relative to the obstacle if it meets it, when it moves by
  /// this; 0 if no way is too long.
  double longest_way(double way) const {
    return long_way_ < infinity ? (way + own_way_) * spin_factor_ : 0;
  }
  /// How the normal of gap() turns with the place.
  Curvature curvature(const Vec3& place) const;

  /// Moves the end of a path out of the obstacle, with Coulomb friction against sliding, and adds
  /// to `push`. Returns dv_n, 0 if it is not inside.
  ///   dv_n = (target - gap) / dt,   dv_t = - u_t min(1, mu dv_n / |u_t|)
  /// u_t is the rest of the tangential velocity relative to the obstacle. The target is 0, so that
  /// a vertex ends the step on the surface; one that was inside before approaches it slowly
  /// (`fastest` m per step), or pushing out would act like an explosion.
  double push(VertexPath& path, double fastest, Push& push) const;
  /// Of what a step may take back of an earlier depth, it takes this part back.
  void ease_recovery(double part) { eased_ = part; }

  /// Whether it pushes in the same direction and moves with the same velocity
  /// everywhere.
  bool is_plane() const { return is_half_space_ && start_.turn == end_.turn; }
  /// Of such an obstacle; m/s.
  const Vec3& normal() const { return normal_; }
  Vec3 velocity(double dt) const { return scaled(1 / dt, displacement(end_.place({}))); }
  /// The way along the normal by which the end of a path misses the target of
  /// push(), m.
  double lacking(const VertexPath& path, double fastest) const {
    return target(path, fastest) - gap(path.end).distance;
  }

  /// In the step, of that point of the obstacle which is there at the end.
  Vec3 displacement(const Vec3& place_at_end) const {
    return stands_ ? Vec3{} : minus(place_at_end, start_.place(end_.given(place_at_end)));
  }

  /// A point that turns with the obstacle, about which torques are taken.
  Vec3 centre() const { return ball_.centre; }

 private:
  bool surface_may_touch(const Vec3& place, double margin) const {
    return may_be_within(obstacle_.shape, end_.given(place), offset_ + margin);
  }
  Nearest gap(const Pose& pose, const Vec3& place) const {
    if (is_half_space_ && stands_)  // a floor
      return {dot(minus(place, ball_.centre), normal_) - offset_, normal_};
    return gap_of_shape(pose, place);
  }
  Nearest gap_of_shape(const Pose& pose, const Vec3& place) const;
  double longest_way(const Vec3& from, const Vec3& to) const {
    return long_way_ < infinity ? longest_way(norm(minus(to, from))) : 0;
  }
  double target(const VertexPath& path, double fastest) const;
  void bound_own_way();

  const Obstacle& obstacle_;
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  double offset_;
  double long_way_;  ///< a vertex that moves by less stays nearest to the side that it meets, m
  double eased_ = 1;
  double own_way_ = 0, spin_factor_ = 1;  ///< of longest_way()
  Pose start_, end_;
  Ball ball_;
  Vec3 normal_{};  ///< of a half-space
  bool is_half_space_, is_triangulated_, stands_;
  bool is_as_given_ = false;  ///< at both ends: most obstacles stand
};

}  // namespace suture
