// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/shape.hpp"

#include <algorithm>
#include <limits>

#include "kernel/base/rows.hpp"
#include "kernel/geometry/solid_surface.hpp"

namespace suture {
namespace {

/// In the middle of a shape every direction leads out.
constexpr Vec3 any_direction{0, 0, 1};

Nearest from_core(const Vec3& core, double radius, const Vec3& place) {
  const Vec3 away = minus(place, core);
  const double length = norm(away);
  return {length - radius, length > 0 ? scaled(1 / length, away) : any_direction};
}

/// Where the place lies along from -> to: 0 at `from`, 1 at `to`.
double along(const Vec3& from, const Vec3& to, const Vec3& place) {
  const Vec3 axis = minus(to, from);
  return dot(minus(place, from), axis) / dot(axis, axis);
}

Vec3 point_between(const Vec3& from, const Vec3& to, double part) {
  return plus(from, scaled(part, minus(to, from)));
}

/// From how far a place is outside along directions at right angles (negative: inside).
template <std::size_t n>
Nearest from_sides(const std::array<double, n>& outside, const std::array<Vec3, n>& directions) {
  double squared = 0;
  Vec3 away{};
  for (std::size_t i = 0; i < n; ++i) {
    if (!(outside[i] > 0)) continue;
    squared += outside[i] * outside[i];
    away = plus(away, scaled(outside[i], directions[i]));
  }
  if (squared > 0) return {std::sqrt(squared), scaled(1 / std::sqrt(squared), away)};
  const auto side = std::ranges::max_element(outside) - outside.begin();
  return {outside[static_cast<std::size_t>(side)], directions[static_cast<std::size_t>(side)]};
}

struct NearestTo {
  const Vec3& place;

  Nearest operator()(const HalfSpace& s) const {
    return {dot(minus(place, s.point), s.normal), s.normal};
  }
  Nearest operator()(const Sphere& s) const { return from_core(s.centre, s.radius, place); }
  Nearest operator()(const Capsule& s) const {
    const double part = std::clamp(along(s.from, s.to, place), 0.0, 1.0);
    return from_core(point_between(s.from, s.to, part), s.radius, place);
  }
  Nearest operator()(const Box& s) const {
    std::array<double, 3> outside;
    std::array<Vec3, 3> directions{};
    for (std::size_t c = 0; c < 3; ++c) {
      const bool is_low = place[c] - s.low[c] < s.high[c] - place[c];
      outside[c] = is_low ? s.low[c] - place[c] : place[c] - s.high[c];
      directions[c][c] = is_low ? -1 : 1;
    }
    return from_sides(outside, directions);
  }
  Nearest operator()(const Cylinder& s) const {
    const Vec3 axis = minus(s.to, s.from);
    const double length = norm(axis), part = along(s.from, s.to, place);
    const Nearest side = from_core(point_between(s.from, s.to, part), s.radius, place);
    const bool is_low = part < 0.5;
    return from_sides<2>({side.distance, (is_low ? -part : part - 1) * length},
                         {side.normal, scaled((is_low ? -1 : 1) / length, axis)});
  }
  Nearest operator()(const Triangulated& s) const {
    return s.surface->nearest(minus(place, s.middle));
  }
};

struct BallAround {
  Ball operator()(const HalfSpace& s) const {
    return {s.point, std::numeric_limits<double>::infinity()};
  }
  Ball operator()(const Sphere& s) const { return {s.centre, s.radius}; }
  Ball operator()(const Capsule& s) const {
    return {point_between(s.from, s.to, 0.5), norm(minus(s.to, s.from)) / 2 + s.radius};
  }
  Ball operator()(const Box& s) const {
    return {point_between(s.low, s.high, 0.5), norm(minus(s.high, s.low)) / 2};
  }
  Ball operator()(const Cylinder& s) const {
    return {point_between(s.from, s.to, 0.5), std::hypot(norm(minus(s.to, s.from)) / 2, s.radius)};
  }
  Ball operator()(const Triangulated& s) const { return {s.middle, s.surface->radius()}; }
};

/// In ascending order, along three axes at right angles.
struct Extents {
  using Three = std::array<double, 3>;
  Three operator()(const HalfSpace&) const {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {infinity, infinity, infinity};
  }
  Three operator()(const Sphere& s) const { return {2 * s.radius, 2 * s.radius, 2 * s.radius}; }
  Three operator()(const Capsule& s) const {
    return sorted({2 * s.radius, 2 * s.radius, norm(minus(s.to, s.from)) + 2 * s.radius});
  }
  Three operator()(const Box& s) const { return sorted({s.length(0), s.length(1), s.length(2)}); }
  Three operator()(const Cylinder& s) const {
    return sorted({2 * s.radius, 2 * s.radius, norm(minus(s.to, s.from))});
  }
  Three operator()(const Triangulated& s) const { return sorted(s.surface->extents()); }
  static Three sorted(Three extents) {
    std::ranges::sort(extents);
    return extents;
  }
};

struct PointsInside {
  std::vector<Vec3> operator()(const HalfSpace&) const { return {}; }
  std::vector<Vec3> operator()(const Sphere& s) const { return {s.centre}; }
  std::vector<Vec3> operator()(const Capsule& s) const { return along_axis(s.from, s.to); }
  std::vector<Vec3> operator()(const Cylinder& s) const { return along_axis(s.from, s.to); }
  std::vector<Vec3> operator()(const Box& s) const {
    std::vector<Vec3> points{point_between(s.low, s.high, 0.5)};
    for (unsigned corner = 0; corner < 8; ++corner) {
      Vec3 p;
      for (std::size_t c = 0; c < 3; ++c) p[c] = corner >> c & 1 ? s.high[c] : s.low[c];
      points.push_back(p);
    }
    return points;
  }
  std::vector<Vec3> operator()(const Triangulated& s) const {
    std::vector<Vec3> points = s.surface->points_inside();
    for (Vec3& p : points) p = plus(p, s.middle);
    return points;
  }
  static std::vector<Vec3> along_axis(const Vec3& from, const Vec3& to) {
    constexpr int parts = 8;
    std::vector<Vec3> points;
    for (int i = 0; i <= parts; ++i) points.push_back(point_between(from, to, double(i) / parts));
    return points;
  }
};

struct Translate {
  const Vec3& by;
  void operator()(HalfSpace& s) const { s.point = plus(s.point, by); }
  void operator()(Sphere& s) const { s.centre = plus(s.centre, by); }
  void operator()(Box& s) const {
    s.low = plus(s.low, by);
    s.high = plus(s.high, by);
  }
  void operator()(Triangulated& s) const { s.middle = plus(s.middle, by); }
  template <class WithAxis>
  void operator()(WithAxis& s) const {
    s.from = plus(s.from, by);
    s.to = plus(s.to, by);
  }
};

}  // namespace

Nearest nearest(const Shape& shape, const Vec3& place) {
  return std::visit(NearestTo{place}, shape);
}
bool may_be_within(const Shape& shape, const Vec3& place, double distance) {
  const auto* s = std::get_if<Triangulated>(&shape);
  return s == nullptr || s->surface->may_be_within(minus(place, s->middle), distance);
}
Ball ball_around(const Shape& shape) { return std::visit(BallAround{}, shape); }
double thickness(const Shape& shape) {
  const auto* s = std::get_if<Triangulated>(&shape);
  return s ? s->surface->thickness() : std::visit(Extents{}, shape)[0];
}
double width(const Shape& shape) { return std::visit(Extents{}, shape)[1]; }
std::vector<Vec3> points_inside(const Shape& shape) { return std::visit(PointsInside{}, shape); }
void translate(Shape& shape, const Vec3& by) { std::visit(Translate{by}, shape); }

const char* name_of(const Shape& shape) {
  static constexpr const char* names[] = {"half_space", "sphere",   "capsule",
                                          "box",        "cylinder", "surface"};
  static_assert(std::size(names) == std::variant_size_v<Shape>);
  return names[shape.index()];
}

}  // namespace suture
