// SPDX-License-Identifier: GPL-3.0-or-later
// A step in which obstacles and other points push the points of an embedded surface. Points share
// vertices: they are pushed one after the other, in sweeps, until none moves. A sweep skips points
// that others have not moved since they were pushed: most of those near a wall.
#include <algorithm>
#include <numeric>

#include "kernel/contact/contact.hpp"
#include "kernel/topology/disjoint_sets.hpp"

namespace suture {
namespace {

constexpr int most_pushes = 64;
// Where points touch triangles, sweeps end at this error of a gap, in edges, or at this part of the
// change in the first sweep, if that is less: a pile comes to rest only if both are small.
constexpr double precision_of_pairs = 1e-4, lag_of_pairs = 0.1;

}  // namespace

bool Contact::is_free(Index point, const LiveMask& moving) const {
  return std::ranges::any_of((*points_)[point].vertices, [&](Index v) {
    return moving[v] && attributes_.fixed().rows()[v] != all_held;
  });
}

void Contact::add_near_point(Index number) { add_point((*points_)[number]); }

const PointPairs* Contact::find_point_pairs() {
  if (!pairs_) return nullptr;
  pairs_->set_depth(PieceContact::max_depth);
  points_->gather(attributes_);
  pairs_->find();
  return &*pairs_;
}

const double* Contact::places_now() {
  if (!points_) return attributes_.position().rows();
  points_->gather(attributes_);
  return points_->positions();
}

/// After the points near obstacles.
void Contact::find_pairs() {
  first_pair_ = pushed_.size();
  pairs_->find(moving_);
  pair_tangential_.assign(pairs_->size(), {});
  for (std::size_t i = 0; i < pairs_->size(); ++i) {
    add_point((*pairs_)[i]);
    pushed_.emplace_back(static_cast<Index>(i), pushes_.size());
  }
}

void Contact::add_point(const ContactPoint& point) {
  point_masses_.emplace_back(point, attributes_, moving_);
  near_of_vertex_.resize(attributes_.vertex_count(), none);
  for (const Index v : point.vertices) {
    Index& place = near_of_vertex_[v];
    if (place == none) {
      place = static_cast<Index>(near_.size());
      add_near(v);
    }
    near_of_points_.push_back(place);
  }
  first_near_.push_back(near_of_points_.size());
}

/// Points that share no vertex, directly or through others, do not push each other: each group has
/// sweeps of its own.
void Contact::push_points(double dt) {
  directions_.assign(pushed_.size(), {});
  residuals_.assign(pushed_.size(), {});
  seen_.assign(pushed_.size(), -1);
  ways_.assign(near_.size(), 0);
  group_points();
  for (auto first = grouped_.begin(); first != grouped_.end();) {
    const auto last = std::find_if(
        first, grouped_.end(), [&](const Grouped& point) { return point.group != first->group; });
    push_group({first, last}, dt);
    first = last;
  }
}

void Contact::group_points() {
  DisjointSets sets(near_.size());
  const auto first_near = [&](std::size_t i) { return near_of_point(i).front(); };
  for (std::size_t i = 0; i < pushed_.size(); ++i)
    for (const Index near : near_of_point(i).subspan(1)) sets.unite(first_near(i), near);
  std::vector<std::size_t> first(near_.size() + 1, 0);  // of each group, in grouped_
  for (std::size_t i = 0; i < pushed_.size(); ++i) ++first[sets.find(first_near(i)) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  grouped_.resize(pushed_.size());
  const std::size_t pairs = pairs_ ? pairs_->size() : 0;
  for (std::size_t k = 0; k < pushed_.size(); ++k) {
    const std::size_t i = k < pairs ? first_pair_ + k : k - pairs;
    const std::size_t group = sets.find(first_near(i));
    grouped_[first[group]++] = {group, i};
  }
}

/// Pairs come first in a group. Their sweeps end sooner; what obstacles push is then swept without
/// them, so that nothing is left inside.
void Contact::push_group(std::span<const Grouped> group, double dt) {
  const auto first_pair = pairs_ ? first_pair_ : pushed_.size();
  const auto alone =
      std::ranges::find_if(group, [&](const Grouped& point) { return point.place < first_pair; });
  const bool has_pairs = alone != group.begin();
  sweep_group(group, has_pairs, dt);
  if (has_pairs) sweep_group({alone, group.end()}, false, dt);
}

/// By sweeps of Gauss and Seidel, after each of which the pushes go on in the direction of the last
/// ones, as conjugate gradients do (Silcowitz, Niebe and Erleben, Vis. Comput. 26 (2010) 893). The
/// last sweep has the last word: each push obeys the law of contact.
void Contact::sweep_group(std::span<const Grouped> group, bool has_pairs, double dt) {
  double last = 0, precision = least_push * shortest_edge_;
  for (int sweep = 0; sweep < most_pushes; ++sweep) {
    const auto [largest, size] = sweep_points(group, dt);
    if (sweep == 0 && has_pairs)
      precision = std::max(precision,
                           std::min(precision_of_pairs * mean_edge_, lag_of_pairs * dt * largest));
    if (dt * largest <= precision || sweep + 1 == most_pushes) break;
    const double factor = sweep == 0 || size > last ? 0 : size / last;
    last = size;
    for (const auto [of, i] : group) {
      const Vec3 more = scaled(factor, directions_[i]);
      directions_[i] = plus(more, residuals_[i]);
      if (more == Vec3{}) continue;
      change_point(i, more, dt);
      pushed_[i].change = plus(pushed_[i].change, more);
    }
  }
}

/// Returns the largest change of a velocity, m/s, and twice the kinetic energy of all changes, J.
/// Points are skipped that others have not moved.
std::array<double, 2> Contact::sweep_points(std::span<const Grouped> group, double dt) {
  double largest = 0, size = 0;
  for (const auto [of, i] : group) {
    residuals_[i] = {};
    const double way = way_of_point(i);
    if (way <= seen_[i]) continue;
    residuals_[i] = push_point(i, dt);
    seen_[i] = residuals_[i] == Vec3{} ? way : way_of_point(i);
    const double squared = dot(residuals_[i], residuals_[i]);
    largest = std::max(largest, squared);
    size += point_masses_[i].mass()[0] * squared;
  }
  return {std::sqrt(largest), size};
}

/// What an earlier sweep did is taken back before: other points may hold its vertices now. Returns
/// the change of its velocity, m/s.
Vec3 Contact::push_point(std::size_t i, double dt) {
  Pushed& pushed = pushed_[i];
  const PointMass& mass = point_masses_[i];
  const Vec3 last = pushed.change;
  const Vec3 end = minus(mass.point().sum(attributes_.position().rows()), scaled(dt, last));
  const Vec3 velocity = minus(mass.point().sum(attributes_.velocity().rows()), last);
  pushed.change = change_of(i, end, velocity, dt);
  const Vec3 change = minus(pushed.change, last);
  if (change != Vec3{}) change_point(i, change, dt);
  return change;
}

void Contact::change_point(std::size_t i, const Vec3& by, double dt) {
  const PointMass& mass = point_masses_[i];
  mass.change(by, dt);
  const double impulse = norm(mass.impulse(by));
  const ContactPoint& point = mass.point();
  const std::span<const Index> near = near_of_point(i);
  for (std::size_t j = 0; j < near.size(); ++j)
    ways_[near[j]] +=
        dt * std::abs(point.weights[j]) * impulse / attributes_.mass().rows()[point.vertices[j]];
}

/// How far its vertices have taken a point since the sweeps began, m; at most.
double Contact::way_of_point(std::size_t i) const {
  const ContactPoint& point = point_masses_[i].point();
  const std::span<const Index> near = near_of_point(i);
  double way = 0;
  for (std::size_t j = 0; j < near.size(); ++j) way += std::abs(point.weights[j]) * ways_[near[j]];
  return way;
}

Vec3 Contact::change_of(std::size_t i, const Vec3& end, const Vec3& velocity, double dt) {
  const unsigned fixed = point_masses_[i].fixed();
  if (pairs_ && i >= first_pair_) {
    const auto [normal, tangential] = pairs_->change(i - first_pair_, end, velocity, fixed, dt);
    pair_tangential_[i - first_pair_] = tangential;
    return plus(normal, tangential);
  }
  VertexPath path{minus(end, scaled(dt, velocity)), end, {}, fixed, dt};
  push_path(path, pushes_on(i));
  return path.change;
}

/// As for obstacles, with the mean sliding of the point over the triangle.
void Contact::book_pairs(const ContactStep& step) {
  for (std::size_t i = 0; i < pair_tangential_.size(); ++i) {
    if (pair_tangential_[i] == Vec3{}) continue;
    const PointMass& of = point_masses_[first_pair_ + i];
    const Vec3 mean = mean_velocity(of.point(), step);
    const double heat = -step.work_gain * dot(of.impulse(pair_tangential_[i]), mean);
    work_ += heat;
    friction_work_ -= heat;
  }
}

/// Which pieces press on each other, and what they would do to those that sleep: by the impulse of
/// the step, and that of the next one where a gap is about to close.
void Contact::note_pairs(const ContactStep& step) {
  pair_presses_.clear();
  pushed_sleepers_.clear();
  const auto first_vertex = [&](Index point) { return (*points_)[point].vertices[0]; };
  for (std::size_t i = 0; i < pairs_->size(); ++i) {
    const PointMass& of = point_masses_[first_pair_ + i];
    const ContactPoint& point = of.point();
    const Vec3& normal = pairs_->normal(i);
    double impulse = dot(normal, of.impulse(pushed_[first_pair_ + i].change));
    if (impulse != 0)
      pair_presses_.push_back({first_vertex(pairs_->point(i)),
                               first_vertex(points_->triangles()[pairs_->triangle(i)][0])});
    if (step.moving->all()) continue;
    const double gap = dot(normal, point.sum(attributes_.position().rows())),
                 speed = dot(normal, point.sum(attributes_.velocity().rows())),
                 closing = std::max(0.0, -std::max(gap, 0.0) / step.dt - speed);
    impulse += dot(normal, of.impulse(scaled(closing, normal)));
    for (std::size_t j = 0; j < point.vertices.size() && impulse != 0; ++j)
      if (const Index v = point.vertices[j]; !(*step.moving)[v])
        pushed_sleepers_.push_back({v, std::abs(point.weights[j]) * impulse /
                                           (attributes_.mass().rows()[v] * step.whole_gain)});
  }
}

/// The work of the forces on vertices is booked; here, that of friction is found in it.
void Contact::book_points(const ContactStep& step) {
  for (std::size_t i = 0; i < pushed_.size(); ++i) {
    const PointMass& of = point_masses_[i];
    const ContactPoint& point = of.point();
    for (const auto& [number, obstacle, push] : pushes_on(i)) {
      if (push.normal == Vec3{}) continue;
      const Vec3 mean = mean_velocity(point, step);
      const double heat =
          -step.work_gain * dot(of.impulse(push.tangential), minus(mean, push.obstacle_velocity));
      work_ += heat;
      friction_work_ -= heat;
      const Vec3 on = scaled(1 / step.whole_gain, of.impulse(plus(push.normal, push.tangential)));
      for (std::size_t j = 0; j < point.vertices.size(); ++j)
        obstacle_forces_.push_back({point.vertices[j], obstacle, scaled(point.weights[j], on)});
    }
  }
}

/// Interpolates from its vertices, which are all in near_, m/s.
Vec3 Contact::mean_velocity(const ContactPoint& point, const ContactStep& step) const {
  Vec3 mean{};
  for (std::size_t j = 0; j < point.vertices.size(); ++j) {
    const Near& near = near_[near_of_vertex_[point.vertices[j]]];
    const Vec3 of_vertex =
        near.is_booked ? near.mean : mean_velocity(near, free_force(near, step), step);
    mean = plus(mean, scaled(point.weights[j], of_vertex));
  }
  return mean;
}

}  // namespace suture
