// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/placed_obstacle.hpp"

#include <algorithm>

namespace suture {
namespace {

// Of its depth, by which a vertex that began inside moves out in a step.
constexpr double recovery = 0.02;
// Below, all directions of the normal are held by constraints.
constexpr double least_free_part = 1e-6;

}  // namespace

PlacedObstacle::PlacedObstacle(const Obstacle& obstacle, double thickness, const Pose& start,
                               const Pose& end)
    : obstacle_(obstacle),
      offset_(thickness),
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
}

Nearest PlacedObstacle::gap_of_shape(const Pose& pose, const Vec3& place) const {
  Nearest found = nearest(obstacle_.shape, is_as_given_ ? place : pose.given(place));
  found.distance -= offset_;
  if (!is_as_given_) found.normal = pose.direction(found.normal);
  return found;
}

double PlacedObstacle::target(const VertexPath& path, double fastest) const {
  const double before = gap(start_, path.start).distance;
  return before < 0 ? before + std::min(-recovery * before, fastest) : 0;
}

double PlacedObstacle::push(VertexPath& path, double fastest, Push& push) const {
  if (!is_half_space_ && !may_touch(path.end, 0)) return 0;  // cheaper
  const Nearest found = gap(path.end);
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
