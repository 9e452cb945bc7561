// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/point_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/base/rows.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/contact/place_grid.hpp"
#include "kernel/geometry/surface_tree.hpp"
#include "kernel/topology/islands.hpp"

namespace suture {
void PointPairs::find(const LiveMask* moving) {
  if (is_stale_) find_pieces();
  if (may_meet_ && (is_stale_ || has_moved())) find_near();
  is_stale_ = false;
  pairs_.clear();
  near_points_.clear();
  vertices_.clear();
  weights_.clear();
  if (!may_meet_) return;
  find_normals();
  for (auto first = near_.begin(); first != near_.end();) {
    const auto last = std::find_if(first, near_.end(),
                                   [&](const Near& near) { return near.vertex != first->vertex; });
    add_nearest({first, last}, moving);
    first = last;
  }
  for (const Pair& pair : pairs_) {
    near_points_.push_back(pair.point);
    const auto& corners = points_.triangles()[pair.triangle];
    near_points_.insert(near_points_.end(), corners.begin(), corners.end());
  }
}

// ------------------------------------------------------------------ what may meet --

void PointPairs::find_pieces() {
  const Islands islands(complex_);
  piece_of_.assign(points_.size(), none);
  for (std::size_t t = 0; t < points_.triangles().size(); ++t)
    for (const Index p : points_.triangles()[t])
      piece_of_[p] = islands.of(points_.triangle_element(t));
  may_meet_ = options_.self || islands.existing() > 1 || points_.has_lips();
}

Vec3 PointPairs::place(Index point) const { return row(points_.positions(), point); }

bool PointPairs::has_moved() const {
  const double limit = edge_ * skin / 2;
  for (Index p = 0; p < searched_at_.size(); ++p) {
    const Vec3 way = minus(place(p), searched_at_[p]);
    if (dot(way, way) > limit * limit) return true;
  }
  return false;
}

void PointPairs::find_near() {
  const double reach = (max_depth_ + skin) * edge_;
  searched_at_.clear();
  std::vector<PlaceGrid::Entry> entries;
  for (Index p = 0; p < points_.size(); ++p) {
    searched_at_.push_back(place(p));
    entries.push_back({place(p), p, piece_of_[p]});
  }
  PlaceGrid grid(entries, 3 * reach, 2 * reach);
  std::vector<Near> near;
  for (Index t = 0; t < points_.triangles().size(); ++t) {
    Box box = no_box;
    for (const Index p : points_.triangles()[t]) include(box, place(p));
    const bool may_be_same = options_.self || points_.is_laid_open(t);
    const Index except = may_be_same ? none : piece_of_[points_.triangles()[t][0]];
    for (const Index p : grid.find(enlarged(box, reach), except))
      if (may_touch(p, t)) near.push_back({p, t});
  }
  near_ = sorted_once(near, points_.size());
  find_around_near();
}

/// The normals of near points need all triangles around them, and pairs those of near triangles:
/// all that find_normals() visits in a step.
void PointPairs::find_around_near() {
  is_near_.assign(points_.size(), 0);
  std::vector<std::uint8_t> is_around(points_.triangles().size(), 0);
  for (const auto& [point, triangle] : near_) is_near_[point] = is_around[triangle] = 1;
  around_near_.clear();
  for (Index t = 0; t < is_around.size(); ++t) {
    const auto& corners = points_.triangles()[t];
    if (is_around[t] != 0 ||
        std::ranges::any_of(corners, [&](Index p) { return is_near_[p] != 0; }))
      around_near_.push_back(t);
  }
}

/// Within a piece, lips touch lips, and not what was behind them at rest, where only material is in
/// between. With `self`, so does all that was in front of each other, but for neighbours in the
/// surface, and all that was far apart.
bool PointPairs::may_touch(Index point, Index triangle) const {
  const auto& [a, b, c] = points_.triangles()[triangle];
  if (point == a || point == b || point == c) return false;
  if (piece_of_[point] != piece_of_[a]) return true;
  const bool are_lips = points_.is_lip(point) && points_.is_laid_open(triangle);
  if (!are_lips && !options_.self) return false;
  const Vec3 at = rest(a), normal = cross(minus(rest(b), at), minus(rest(c), at));
  const Vec3 offset = minus(rest(point), at);
  const double least = are_lips ? -level : margin;
  return dot(offset, normal) > least * edge_ * norm(normal) ||
         (options_.self && norm(offset) > far_apart * edge_);
}

// -------------------------------------------------------------------- in a step --

void PointPairs::find_normals() {
  planes_.resize(points_.triangles().size());
  normals_.resize(points_.size());
  for (const Near& near : near_) normals_[near.vertex] = {};
  for (const Index t : around_near_) {
    const auto& corners = points_.triangles()[t];
    const Vec3 at = place(corners[0]);
    const Vec3 area = cross(minus(place(corners[1]), at), minus(place(corners[2]), at));
    const double size = norm(area);
    const Vec3 normal = size > 0 ? scaled(1 / size, area) : Vec3{};
    planes_[t] = {normal, dot(normal, at)};
    for (const Index p : corners)
      if (is_near_[p] != 0) normals_[p] = plus(normals_[p], area);
  }
}

/// The nearest triangle that looks at the point. Lips that have just been made have the same places
/// on both sides.
void PointPairs::add_nearest(std::span<const Near> of_point, const LiveMask* moving) {
  const Index p = of_point.front().vertex;
  const Vec3 at = place(p);
  const double same = same_side * norm(normals_[p]);
  double least = max_depth_ * edge_;
  Index nearest = none;
  Vec3 weights{}, towards{};
  for (const auto& [point, triangle] : of_point) {
    const auto& [normal, offset_of_plane] = planes_[triangle];
    const double gap = dot(at, normal) - offset_of_plane;  // no point of it is nearer
    if (gap > margin * edge_ || std::abs(gap) >= least) continue;
    if (normal == Vec3{} || dot(normals_[p], normal) > same) continue;
    const auto& [a, b, c] = points_.triangles()[triangle];
    const Weights of = nearest_in(place(a), place(b), place(c), at);
    const Vec3 foot =
        plus(scaled(of.a, place(a)), plus(scaled(of.b, place(b)), scaled(of.c, place(c))));
    const Vec3 offset = minus(at, foot);
    const double distance = norm(offset);
    if (distance >= least || norm(minus(offset, scaled(gap, normal))) > beside * edge_) continue;
    least = distance;
    nearest = triangle;
    weights = {of.a, of.b, of.c};
    towards = normal;
  }
  if (nearest == none) return;
  const std::size_t first = vertices_.size();
  add(p, 1);
  for (std::size_t i = 0; i < 3; ++i)
    if (weights[i] != 0) add(points_.triangles()[nearest][i], -weights[i]);
  double lever = 0;
  for (std::size_t i = first; i < weights_.size(); ++i) lever += std::abs(weights_[i]) / 2;
  const auto moves = [&](Index v) { return !moving || (*moving)[v]; };
  if (lever >= least_lever &&
      std::any_of(vertices_.begin() + std::ptrdiff_t(first), vertices_.end(), moves))
    return pairs_.push_back({first, vertices_.size(), p, nearest, towards, lever});
  vertices_.resize(first);
  weights_.resize(first);
}

/// Vertices of several corners have the sum of their weights.
void PointPairs::add(Index point, double weight) {
  const ContactPoint of = points_[point];
  const auto first = pairs_.empty() ? 0 : pairs_.back().end;
  for (std::size_t i = 0; i < of.vertices.size(); ++i) {
    const auto known =
        std::find(vertices_.begin() + std::ptrdiff_t(first), vertices_.end(), of.vertices[i]);
    if (known == vertices_.end()) {
      vertices_.push_back(of.vertices[i]);
      weights_.push_back(weight * of.weights[i]);
    } else {
      weights_[std::size_t(known - vertices_.begin())] += weight * of.weights[i];
    }
  }
}

PointPairs::Change PointPairs::change(std::size_t i, const Vec3& offset, const Vec3& velocity,
                                      unsigned fixed, double dt) const {
  const auto& [first, end, point, triangle, normal, lever] = pairs_[i];
  const double gap = dot(normal, offset), speed = dot(normal, velocity), before = gap - dt * speed;
  const double target =
      before < 0 ? before + std::min(-recovered * before, max_recovery * lever * edge_) : 0;
  if (gap >= target) return {};
  const auto free_part = [&](Vec3 a) {
    for (std::size_t c = 0; c < 3; ++c)
      if ((fixed >> c & 1) != 0) a[c] = 0;
    return a;
  };
  const Vec3 along = free_part(normal);
  const double free = dot(along, along), missing = (target - gap) / dt;
  if (free < least_free) return {};
  const Vec3 sliding = free_part(minus(velocity, scaled(speed, normal)));
  const double size = norm(sliding), most = options_.friction * missing;
  return {scaled(missing / free, along),
          size > 0 ? scaled(-std::min(1.0, most / size), sliding) : Vec3{}};
}

}  // namespace suture
