// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/point_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "kernel/base/rows.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/contact/place_grid.hpp"
#include "kernel/geometry/surface_tree.hpp"
#include "kernel/topology/islands.hpp"

namespace suture {
void PointPairs::find(double back, const LiveMask* moving) {
  if (is_stale_) find_pieces();
  if (may_meet_) gather_places(back);
  if (may_meet_ && (is_stale_ || has_moved())) find_near();
  is_stale_ = false;
  pairs_.clear();
  near_points_.clear();
  vertices_.clear();
  weights_.clear();
  if (!may_meet_) return;
  ++step_;
  for (std::size_t i = 0; i + 1 < first_of_point_.size(); ++i)
    add_nearest(first_of_point_[i], first_of_point_[i + 1], moving);
  for (const Pair& pair : pairs_) {
    near_points_.push_back(pair.point);
    const auto& corners = points_.triangles()[pair.triangle];
    near_points_.insert(near_points_.end(), corners.begin(), corners.end());
  }
}

void PointPairs::gather_places(double back) {
  places_.resize(4 * std::size_t{points_.size()});
  const double *x = points_.positions(), *v = points_.velocities();
  for (std::size_t i = 0; i < places_.size(); ++i) places_[i] = x[i] - back * v[i];
}

// ------------------------------------------------------------------ what may meet --

void PointPairs::find_pieces() {
  const Islands islands(complex_);
  piece_of_.assign(points_.size(), none);
  for (std::size_t t = 0; t < points_.triangles().size(); ++t)
    for (const Index p : points_.triangles()[t])
      piece_of_[p] = islands.of(points_.triangle_element(t));
  may_meet_ = options_.self || islands.existing() > 1 || points_.has_lips();
  if (may_meet_) find_triangles_at_points();
}

void PointPairs::find_triangles_at_points() {
  first_at_.assign(points_.size() + 1, 0);
  for (const auto& corners : points_.triangles())
    for (const Index p : corners) ++first_at_[p + 1];
  std::partial_sum(first_at_.begin(), first_at_.end(), first_at_.begin());
  at_.resize(3 * points_.triangles().size());
  std::vector<Index> next = first_at_;
  for (Index t = 0; t < points_.triangles().size(); ++t)
    for (const Index p : points_.triangles()[t]) at_[next[p]++] = t;
}

/// Since the last search; notes how far since the last call.
bool PointPairs::has_moved() {
  double since_search = 0, since_last = 0;
  for (Index p = 0; p < searched_at_.size(); ++p) {
    const Vec3 here = place(p), way = minus(here, searched_at_[p]),
               step = minus(here, last_place_[p]);
    since_search = std::max(since_search, dot(way, way));
    since_last = std::max(since_last, dot(step, step));
    last_place_[p] = here;
  }
  way_ += std::sqrt(since_last);
  const double limit = edge_ * skin / 2;
  return since_search > limit * limit;
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
  first_of_point_.clear();
  for (std::size_t i = 0; i < near_.size(); ++i)
    if (i == 0 || near_[i].vertex != near_[i - 1].vertex) first_of_point_.push_back(i);
  first_of_point_.push_back(near_.size());
  last_place_ = searched_at_;
  way_ = 0;
  apart_until_.assign(near_.size(), 0);
  planes_.assign(points_.triangles().size(), {});
  step_ = 0;
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

/// That of this step.
const PointPairs::Plane& PointPairs::plane(Index triangle) {
  Plane& plane = planes_[triangle];
  if (plane.step == step_) return plane;
  const auto& [a, b, c] = points_.triangles()[triangle];
  const Vec3 at = place(a), area = cross(minus(place(b), at), minus(place(c), at));
  const double size = norm(area);
  const Vec3 normal = size > 0 ? scaled(1 / size, area) : Vec3{};
  plane = {normal, dot(normal, at), step_};
  return plane;
}

/// The sum of the normals of the triangles at the point, each weighted by the angle that the
/// triangle has there (Baerentzen and Aanaes, IEEE TVCG 11 (2005) 243). Areas as weights would let
/// a large outer face hide the lip at whose rim the point lies. Not of unit length.
Vec3 PointPairs::normal_at(Index point) {
  Vec3 sum{};
  for (Index i = first_at_[point]; i < first_at_[point + 1]; ++i) {
    const auto& corners = points_.triangles()[at_[i]];
    const std::size_t k = corners[0] == point ? 0 : corners[1] == point ? 1 : 2;
    const Vec3 one = minus(place(corners[(k + 1) % 3]), place(point)),
               other = minus(place(corners[(k + 2) % 3]), place(point));
    const double angle = std::atan2(norm(cross(one, other)), dot(one, other));
    sum = plus(sum, scaled(angle, plane(at_[i]).normal));
  }
  return sum;
}

/// Fills close_ with the triangles of a stretch of near_ that are not too far from their point.
void PointPairs::find_close(std::size_t first_near, std::size_t last_near) {
  close_.clear();
  const Vec3 at = place(near_[first_near].vertex);
  const double depth = max_depth_ * edge_;
  for (std::size_t i = first_near; i < last_near; ++i) {
    if (way_ < apart_until_[i]) continue;
    const Index triangle = near_[i].face;
    const auto& [normal, offset_of_plane, step] = plane(triangle);
    const auto& [a, b, c] = points_.triangles()[triangle];
    const double gap = dot(at, normal) - offset_of_plane;  // no point of it is nearer
    // Point and triangle may each come nearer by the way of the fastest.
    const auto is_apart = [&](double distance) {
      if (distance > depth) apart_until_[i] = way_ + 0.499 * (distance - depth);
      return distance > depth;
    };
    if (is_apart(std::abs(gap))) continue;
    const Weights of = nearest_in(place(a), place(b), place(c), at);
    const Vec3 foot =
        plus(scaled(of.a, place(a)), plus(scaled(of.b, place(b)), scaled(of.c, place(c))));
    const double distance = norm(minus(at, foot));
    if (is_apart(distance) || normal == Vec3{}) continue;
    close_.push_back({triangle, {of.a, of.b, of.c}, foot, gap, distance});
  }
}

/// Whether a point that is behind the triangle is outside of its piece: the way to the point from
/// its foot, into the material behind the triangle, leaves that material again. Then the point
/// came from the other side, as that of a lip whose opposite is a thin wedge or sheet.
bool PointPairs::is_behind_material(const Close& close, const Vec3& at) {
  if (close.gap >= 0) return false;
  const double rounding = level * edge_;
  const Index piece = piece_of_[points_.triangles()[close.triangle][0]];
  return std::ranges::any_of(close_, [&](const Close& other) {
    const auto& corners = points_.triangles()[other.triangle];
    if (other.triangle == close.triangle || piece_of_[corners[0]] != piece) return false;
    const Plane& exit = plane(other.triangle);
    const double from = dot(close.foot, exit.normal) - exit.offset;
    if (from >= -rounding || other.gap <= -rounding) return false;
    const double part = std::min(1.0, from / (from - other.gap));
    const Vec3 there = plus(close.foot, scaled(part, minus(at, close.foot)));
    const Weights of = nearest_in(place(corners[0]), place(corners[1]), place(corners[2]), there);
    const Vec3 foot = plus(scaled(of.a, place(corners[0])),
                           plus(scaled(of.b, place(corners[1])), scaled(of.c, place(corners[2]))));
    return norm(minus(there, foot)) <= rounding;
  });
}

/// Of a stretch of near_, the nearest triangle that looks at the point and through which the point
/// may have entered its piece; of those that are equally near, the one that looks at it most. Lips
/// that have just been made have the same places on both sides.
void PointPairs::add_nearest(std::size_t first_near, std::size_t last_near,
                             const LiveMask* moving) {
  find_close(first_near, last_near);
  const Index p = near_[first_near].vertex;
  const Vec3 at = place(p);
  std::optional<Vec3> own_normal;
  const Close* nearest = nullptr;
  double facing = 0;  // cosine
  for (const Close& close : close_) {
    if (close.gap > margin * edge_) continue;
    if (nearest && close.distance > nearest->distance + level * edge_) continue;
    const Vec3& normal = plane(close.triangle).normal;
    const Vec3 offset = minus(at, close.foot);
    if (norm(minus(offset, scaled(close.gap, normal))) > beside * edge_) continue;
    if (!own_normal) {
      own_normal = normal_at(p);
      const double size = norm(*own_normal);
      if (size > 0) own_normal = scaled(1 / size, *own_normal);
    }
    const double cosine = dot(*own_normal, normal);
    if (cosine > same_side) continue;
    const bool is_nearer = !nearest || close.distance < nearest->distance - level * edge_;
    if (!is_nearer && cosine >= facing) continue;
    if (is_behind_material(close, at)) continue;
    nearest = &close;
    facing = cosine;
  }
  if (nearest) add_pair(p, *nearest, moving);
}

/// Unless the point and its triangle hardly move relative to each other, or none of their vertices
/// moves.
void PointPairs::add_pair(Index p, const Close& close, const LiveMask* moving) {
  const std::size_t first = vertices_.size();
  add(p, 1);
  for (std::size_t i = 0; i < 3; ++i)
    if (close.weights[i] != 0) add(points_.triangles()[close.triangle][i], -close.weights[i]);
  const Vec3& normal = plane(close.triangle).normal;
  const Vec3 along = minus(minus(place(p), close.foot), scaled(close.gap, normal));
  const bool is_beside = norm(along) > level * edge_;
  double lever = 0;
  for (std::size_t i = first; i < weights_.size(); ++i) lever += std::abs(weights_[i]) / 2;
  const auto moves = [&](Index v) { return !moving || (*moving)[v]; };
  if (lever >= least_lever &&
      std::any_of(vertices_.begin() + std::ptrdiff_t(first), vertices_.end(), moves))
    return pairs_.push_back({first, vertices_.size(), p, close.triangle, normal, lever, is_beside});
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

double PointPairs::lacking(std::size_t i, const Vec3& offset, const Vec3& velocity,
                           double dt) const {
  const Vec3& normal = pairs_[i].normal;
  const double gap = dot(normal, offset), before = gap - dt * dot(normal, velocity);
  const double most = std::min(-recovered * before, max_recovery * scale_of_recovery(i));
  const double target = before < 0 ? before + eased_ * most : 0;
  return target - gap;
}

PointPairs::Change PointPairs::change(std::size_t i, const Vec3& offset, const Vec3& velocity,
                                      unsigned fixed, double dt) const {
  const Vec3& normal = pairs_[i].normal;
  const double speed = dot(normal, velocity), way = lacking(i, offset, velocity, dt);
  if (!(way > 0)) return {};
  const auto free_part = [&](Vec3 a) {
    for (std::size_t c = 0; c < 3; ++c)
      if ((fixed >> c & 1) != 0) a[c] = 0;
    return a;
  };
  const Vec3 along = free_part(normal);
  const double free = dot(along, along), missing = way / dt;
  if (free < least_free) return {};
  const Vec3 sliding = free_part(minus(velocity, scaled(speed, normal)));
  const double size = norm(sliding), most = options_.friction * missing;
  return {scaled(missing / free, along),
          size > 0 ? scaled(-std::min(1.0, most / size), sliding) : Vec3{}};
}

}  // namespace suture
