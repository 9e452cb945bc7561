// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>

#include "kernel/base/sort_unique.hpp"
#include "kernel/contact/contact.hpp"

namespace suture {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// How far an obstacle moves in a step, and how far pieces may approach, in elements.
constexpr double max_motion = 0.1, max_approach = 0.05;

}  // namespace

std::vector<Index> Contact::near_moving_obstacles(double time, double dt) const {
  std::vector<Index> found;
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    const Pose start = pose(i, time), end = tools_[i] ? start : pose(i, time + dt);
    const bool stands = start.turn == end.turn && start.translation == end.translation;
    if (!tools_[i] && stands) continue;
    const PlacedObstacle placed(obstacles_[i], thickness_, start, end);
    points_.for_each([&](const ContactPoint& point) {
      if (placed.may_touch(point.sum(attributes_.position().rows()), longest_edge_))
        found.insert(found.end(), point.vertices.begin(), point.vertices.end());
    });
  }
  return found;
}

std::vector<double> Contact::gaps(double time) const {
  std::vector<double> gaps(attributes_.vertex_count(), std::numeric_limits<double>::quiet_NaN());
  points_.for_each([&](const ContactPoint& point) {
    for (const Index v : point.vertices) gaps[v] = infinity;
  });
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    const PlacedObstacle placed(obstacles_[i], thickness_, pose(i, time), pose(i, time));
    points_.for_each([&](const ContactPoint& point) {
      const Vec3 place = point.sum(attributes_.position().rows());
      const Vec3* side = kept_.sides.outside(i, point.number);
      const Nearest gap = side ? placed.gap_from(*side, place) : placed.gap(place);
      for (const Index v : point.vertices) gaps[v] = std::min(gaps[v], gap.distance);
    });
  }
  return gaps;
}

std::vector<Index> Contact::vertices_near(std::size_t obstacle, double time,
                                          double distance) const {
  std::vector<Index> found;
  const Pose now = pose(obstacle, time);
  const PlacedObstacle placed(obstacles_[obstacle], thickness_, now, now);
  points_.for_each([&](const ContactPoint& point) {
    if (placed.gap(point.sum(attributes_.position().rows())).distance <= distance)
      found.insert(found.end(), point.vertices.begin(), point.vertices.end());
  });
  sort_unique(found);
  return found;
}

/// A half-space that turns moves fastest where the body is farthest from its centre.
double Contact::top_speed(const Obstacle& obstacle, double time) const {
  double reach = obstacle.reach();
  if (reach == infinity) {
    reach = 0;
    for (const Index v : surface().vertices())
      reach =
          std::max(reach, norm(minus(row(attributes_.rest().rows(), v), obstacle.motion.centre)));
    reach += size_;
  }
  return obstacle.motion.top_speed(time, reach);
}

double Contact::longest_step(double time) const {
  double step = infinity;
  if (kept_.closing_speed > 0) step = max_approach * mean_edge_ / kept_.closing_speed;
  for (std::size_t i = 0; i < obstacles_.size(); ++i) {
    const bool stands = time >= obstacles_[i].motion.last_change();
    double speed = stands ? 0 : top_speed(obstacles_[i], time);
    if (tools_[i]) speed = std::max(speed, tools_[i]->top_speed());
    if (speed > 0) step = std::min(step, max_motion * shortest_edge_ / speed);
  }
  return step;
}

// ------------------------------------------------------------------- sleepers --

void Contact::change_sleepers(const LiveMask& moving) {
  if (pieces_) pieces_->change_sleepers(moving);
  kept_.change_sleepers(moving);
}

void Contact::for_each_pushed_sleeper(const VisitPushed& visit) const {
  if (pieces_) pieces_->for_each_pushed_sleeper(visit);
  for (const auto& [vertex, acceleration] : kept_.pushed_sleepers) visit(vertex, acceleration);
}

std::vector<Contact::Press> Contact::presses() const {
  std::vector<Press> result = kept_.pair_presses;
  result.insert(result.end(), kept_.presses_asleep.begin(), kept_.presses_asleep.end());
  if (!pieces_) return result;
  for (const auto touches : {pieces_->touches(), pieces_->asleep()})
    for (const PieceContact::Touch& touch : touches)
      if (touch.impulse != 0) result.push_back({touch.vertices[0], touch.vertices[4]});
  return result;
}

}  // namespace suture
