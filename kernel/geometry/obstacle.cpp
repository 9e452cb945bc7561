// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/obstacle.hpp"

#include <algorithm>
#include <limits>

#include "kernel/base/archive.hpp"
#include "kernel/base/rows.hpp"

namespace suture {
Vec3 Pose::direction(const Vec3& given) const {
  return {dot(turn[0], given), dot(turn[1], given), dot(turn[2], given)};
}

Vec3 Pose::place(const Vec3& given) const {
  return plus(plus(centre, translation), direction(minus(given, centre)));
}

Vec3 Pose::given(const Vec3& place) const {
  const Vec3 moved = minus(minus(place, centre), translation);
  Vec3 back = centre;
  for (std::size_t i = 0; i < 3; ++i) back = plus(back, scaled(moved[i], turn[i]));
  return back;
}

Pose RigidPath::pose(double time) const {
  Pose pose;
  pose.centre = centre;
  if (stations.empty()) return pose;
  const auto next = std::ranges::upper_bound(stations, time, {}, &Station::at);
  const Station& from = next == stations.begin() ? *next : next[-1];
  const Station& to = next == stations.end() ? from : *next;
  const double part = to.at > from.at ? (time - from.at) / (to.at - from.at) : 0;
  pose.translation = plus(from.translation, scaled(part, minus(to.translation, from.translation)));
  const double angle = from.angle + part * (to.angle - from.angle);
  pose.turn = turned(scaled(angle / norm(axis), axis), turn);
  return pose;
}

double RigidPath::next_change(double time) const {
  const auto next = std::ranges::upper_bound(stations, time, {}, &Station::at);
  return next == stations.end() ? std::numeric_limits<double>::infinity() : next->at;
}

RigidPath RigidPath::steered(double time, const PoseTarget& target) const {
  const Pose now = pose(time);
  RigidPath path{{{time, now.translation, 0}}, axis, centre, now.turn};
  const Vec3 translation = target.translation.value_or(now.translation);
  const Vec3 rotation =
      target.rotation ? rotation_between(now.turn, turned(*target.rotation, no_rotation)) : Vec3{};
  const double angle = norm(rotation);
  if (angle > 0) path.axis = rotation;
  if (angle > 0 || translation != now.translation)
    path.stations.push_back({target.at, translation, angle});
  return path;
}

void RigidPath::state(Archive& archive) {
  archive.rows<double>("stations", stations);
  archive("axis", axis);
  archive("turn", turn);
}

double RigidPath::top_speed(double time, double reach) const {
  double speed = 0;
  for (std::size_t i = 1; i < stations.size(); ++i) {
    const Station &from = stations[i - 1], &to = stations[i];
    if (to.at <= time) continue;
    const double turning = to.angle == from.angle ? 0 : std::abs(to.angle - from.angle) * reach;
    const double path = norm(minus(to.translation, from.translation)) + turning;
    speed = std::max(speed, path / (to.at - from.at));
  }
  return speed;
}

double Obstacle::reach() const {
  const Ball ball = ball_around(shape);
  return norm(minus(ball.centre, motion.centre)) + ball.radius;
}

}  // namespace suture
