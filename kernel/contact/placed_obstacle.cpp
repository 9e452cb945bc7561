// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/placed_obstacle.hpp"

#include <algorithm>
#include <numbers>

#include "kernel/contact/swept_gap.hpp"

namespace suture {
namespace {

// The part of its depth by which a vertex that began inside moves out in a step.
constexpr double recovery = 0.02;
// Below, all directions of the normal are held by constraints.
constexpr double least_free_part = 1e-6;

}  // namespace

PlacedObstacle::PlacedObstacle(const Obstacle& obstacle, double thickness, const Pose& start,
                               const Pose& end)
    : obstacle_(obstacle),
      offset_(thickness),
      long_way_(suture::thickness(obstacle.shape) / 4 + thickness / 2),
      start_(start),
      ball_(ball_around(obstacle.shape)),
      is_half_space_(std::holds_alternative<HalfSpace>(obstacle.shape)),
      is_triangulated_(std::holds_alternative<Triangulated>(obstacle.shape)),
      stands_(!obstacle.motion.moves() && !obstacle.coupling) {
  move_end(end);
}

void PlacedObstacle::move_end(const Pose& end) {
  end_ = end;
  is_as_given_ = start_.is_as_given() && end.is_as_given();
  ball_.centre = end.place(ball_around(obstacle_.shape).centre);
  if (is_half_space_) normal_ = end.direction(std::get<HalfSpace>(obstacle_.shape).normal);
  if (!stands_ && !is_half_space_) bound_own_way();
}

/// With y the place relative to the centre of the ball, R' - R changes it by at most
/// |R' - R| |y| = k |y|, and one that meets the obstacle has |y| < r + way at the start:
///   way < |x' - x| + |c' - c| + k (r + way)
void PlacedObstacle::bound_own_way() {
  double squared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 change = minus(end_.turn[i], start_.turn[i]);
    squared += dot(change, change);
  }
  const double k = std::sqrt(squared) / std::numbers::sqrt2;
  const double way = norm(minus(ball_.centre, start_.place(ball_around(obstacle_.shape).centre)));
  own_way_ = way + k * (ball_.radius + offset_);
  spin_factor_ = k < 1 ? 1 / (1 - k) : infinity;
}

Nearest PlacedObstacle::gap_from(const Vec3& given, const Vec3& place) const {
  const Vec3 end = end_.given(place);
  if (!(norm(minus(end, given)) > long_way_)) return gap(place);
  Nearest found = swept_gap(obstacle_.shape, offset_, given, end);
  found.normal = end_.direction(found.normal);
  return found;
}

Nearest PlacedObstacle::gap_of_shape(const Pose& pose, const Vec3& place) const {
  Nearest found = nearest(obstacle_.shape, is_as_given_ ? place : pose.given(place));
  found.distance -= offset_;
  if (!is_as_given_) found.normal = pose.direction(found.normal);
  return found;
}

Curvature PlacedObstacle::curvature(const Vec3& place) const {
  if (is_half_space_) return {};
  Curvature found = suture::curvature(obstacle_.shape, end_.given(place));
  found.straight = end_.direction(found.straight);
  return found;
}

double PlacedObstacle::target(const VertexPath& path, double fastest) const {
  const double before = gap(start_, path.start).distance;
  return before < 0 ? before + eased_ * std::min(-recovery * before, fastest) : 0;
}

double PlacedObstacle::push(VertexPath& path, double fastest, Push& push) const {
  if (!is_half_space_ && !may_meet(path.start, path.end, 0)) return 0;  // cheaper
  const Nearest found = gap(path.start, path.end);
  if (!(found.distance < 0)) return 0;
  const double lacking = target(path, fastest) - found.distance;
  const Vec3 way = path.free_part(found.normal);
  const double free = dot(found.normal, way);
  if (!(lacking > 0) || free < least_free_part) return 0;
  const double normal = lacking / (path.dt * free);
  push.normal = plus(push.normal, scaled(normal, found.normal));
  path.move(scaled(normal, way));

  const Vec3 moved = displacement(minus(path.end, scaled(offset_, found.normal)));
  const double per_second = 1 / path.dt;
  push.obstacle_velocity = scaled(per_second, moved);
  const Vec3 relative = scaled(per_second, minus(minus(path.end, path.start), moved));
  const Vec3 sliding =
      path.free_part(minus(relative, scaled(dot(relative, found.normal), found.normal)));
  const double speed = norm(sliding);
  push.sliding = std::max(push.sliding, speed);
  if (!(obstacle_.friction > 0) || !(speed > 0)) return normal;
  const Vec3 tangential = scaled(-std::min(1.0, obstacle_.friction * normal / speed), sliding);
  push.tangential = plus(push.tangential, tangential);
  path.move(tangential);
  return normal;
}

}  // namespace suture
