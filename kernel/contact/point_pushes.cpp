// SPDX-License-Identifier: GPL-3.0-or-later
// A sweep skips points that others have not moved since they were pushed: most of those near a
// wall.
#include "kernel/contact/point_pushes.hpp"

#include <algorithm>
#include <numeric>

#include "kernel/topology/disjoint_sets.hpp"

namespace suture {
namespace {

constexpr int most_pushes = 64;
// Where points touch triangles, sweeps end at this error of a gap, in edges, or at this part of the
// change in the first sweep, if that is less: a pile comes to rest only if both are small.
constexpr double precision_of_pairs = 1e-4, lag_of_pairs = 0.1;

}  // namespace

void PointPushes::clear() {
  masses_.clear();
  near_of_points_.clear();
  first_near_.assign(1, 0);
}

/// After the points near obstacles.
void PointPushes::find_pairs() {
  first_pair_ = step_.pushed.size();
  pairs_->find(step_.moving);
  pair_tangential_.assign(pairs_->size(), {});
  for (std::size_t i = 0; i < pairs_->size(); ++i) {
    add((*pairs_)[i]);
    step_.pushed.emplace_back(static_cast<Index>(i), step_.pushes.size());
  }
}

void PointPushes::add(const ContactPoint& point) {
  masses_.emplace_back(point, attributes_, step_.moving);
  step_.near_of_vertex.resize(attributes_.vertex_count(), none);
  for (const Index v : point.vertices) {
    Index& place = step_.near_of_vertex[v];
    if (place == none) {
      place = static_cast<Index>(step_.near.size());
      step_.add_near(attributes_, v);
    }
    near_of_points_.push_back(place);
  }
  first_near_.push_back(near_of_points_.size());
}

/// Points that share no vertex, directly or through others, do not push each other: each group has
/// sweeps of its own.
void PointPushes::push(double dt) {
  directions_.assign(step_.pushed.size(), {});
  residuals_.assign(step_.pushed.size(), {});
  seen_.assign(step_.pushed.size(), -1);
  ways_.assign(step_.near.size(), 0);
  group_points();
  for (auto first = grouped_.begin(); first != grouped_.end();) {
    const auto last = std::find_if(
        first, grouped_.end(), [&](const Grouped& point) { return point.group != first->group; });
    push_group({first, last}, dt);
    first = last;
  }
}

void PointPushes::group_points() {
  DisjointSets sets(step_.near.size());
  const auto first_near = [&](std::size_t i) { return near_of_point(i).front(); };
  for (std::size_t i = 0; i < step_.pushed.size(); ++i)
    for (const Index near : near_of_point(i).subspan(1)) sets.unite(first_near(i), near);
  std::vector<std::size_t> first(step_.near.size() + 1, 0);  // of each group, in grouped_
  for (std::size_t i = 0; i < step_.pushed.size(); ++i) ++first[sets.find(first_near(i)) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  grouped_.resize(step_.pushed.size());
  const std::size_t pairs = pairs_ ? pairs_->size() : 0;
  for (std::size_t k = 0; k < step_.pushed.size(); ++k) {
    const std::size_t i = k < pairs ? first_pair_ + k : k - pairs;
    const std::size_t group = sets.find(first_near(i));
    grouped_[first[group]++] = {group, i};
  }
}

/// Pairs come first in a group. Their sweeps end sooner; what obstacles push is then swept without
/// them, so that nothing is left inside.
void PointPushes::push_group(std::span<const Grouped> group, double dt) {
  const auto first_pair = pairs_ ? first_pair_ : step_.pushed.size();
  const auto alone =
      std::ranges::find_if(group, [&](const Grouped& point) { return point.place < first_pair; });
  const bool has_pairs = alone != group.begin();
  sweep_group(group, has_pairs, dt);
  if (has_pairs) sweep_group({alone, group.end()}, false, dt);
}

/// By sweeps of Gauss and Seidel, after each of which the pushes go on in the direction of the last
/// ones, as conjugate gradients do (Silcowitz, Niebe and Erleben, Vis. Comput. 26 (2010) 893). The
/// last sweep has the last word: each push obeys the law of contact.
void PointPushes::sweep_group(std::span<const Grouped> group, bool has_pairs, double dt) {
  double last = 0, precision = least_push * edge_;
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
      step_.pushed[i].change = plus(step_.pushed[i].change, more);
    }
  }
}

/// Returns the largest change of a velocity, m/s, and twice the kinetic energy of all changes, J.
/// Points are skipped that others have not moved.
std::array<double, 2> PointPushes::sweep_points(std::span<const Grouped> group, double dt) {
  double largest = 0, size = 0;
  for (const auto [of, i] : group) {
    residuals_[i] = {};
    const double way = way_of_point(i);
    if (way <= seen_[i]) continue;
    residuals_[i] = push_point(i, dt);
    seen_[i] = residuals_[i] == Vec3{} ? way : way_of_point(i);
    const double squared = dot(residuals_[i], residuals_[i]);
    largest = std::max(largest, squared);
    size += masses_[i].mass()[0] * squared;
  }
  return {std::sqrt(largest), size};
}

/// What an earlier sweep did is taken back before: other points may hold its vertices now. Returns
/// the change of its velocity, m/s.
Vec3 PointPushes::push_point(std::size_t i, double dt) {
  ContactInProgress::Pushed& pushed = step_.pushed[i];
  const PointMass& mass = masses_[i];
  const Vec3 last = pushed.change;
  const Vec3 end = minus(mass.point().sum(attributes_.position().rows()), scaled(dt, last));
  const Vec3 velocity = minus(mass.point().sum(attributes_.velocity().rows()), last);
  pushed.change = change_of(i, end, velocity, dt);
  const Vec3 change = minus(pushed.change, last);
  if (change != Vec3{}) change_point(i, change, dt);
  return change;
}

void PointPushes::change_point(std::size_t i, const Vec3& by, double dt) {
  const PointMass& mass = masses_[i];
  mass.change(by, dt);
  const double impulse = norm(mass.impulse(by));
  const ContactPoint& point = mass.point();
  const std::span<const Index> near = near_of_point(i);
  for (std::size_t j = 0; j < near.size(); ++j)
    ways_[near[j]] +=
        dt * std::abs(point.weights[j]) * impulse / attributes_.mass().rows()[point.vertices[j]];
}

/// How far its vertices have taken a point since the sweeps began, m; at most.
double PointPushes::way_of_point(std::size_t i) const {
  const ContactPoint& point = masses_[i].point();
  const std::span<const Index> near = near_of_point(i);
  double way = 0;
  for (std::size_t j = 0; j < near.size(); ++j) way += std::abs(point.weights[j]) * ways_[near[j]];
  return way;
}

Vec3 PointPushes::change_of(std::size_t i, const Vec3& end, const Vec3& velocity, double dt) {
  const unsigned fixed = masses_[i].fixed();
  if (pairs_ && i >= first_pair_) {
    const auto [normal, tangential] = pairs_->change(i - first_pair_, end, velocity, fixed, dt);
    pair_tangential_[i - first_pair_] = tangential;
    return plus(normal, tangential);
  }
  VertexPath path{minus(end, scaled(dt, velocity)), end, {}, fixed, dt};
  step_.push_path(path, step_.pushes_on(i), edge_);
  return path.change;
}

}  // namespace suture
