// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/curvature.hpp"

#include "kernel/base/rows.hpp"

namespace suture {
namespace {

Curvature around(const Vec3& away, const Vec3& straight) {
  const double distance = norm(away);
  return distance > 0 ? Curvature{1 / distance, straight} : Curvature{};
}

struct CurvatureAt {
  const Vec3& place;

  Curvature operator()(const Sphere& s) const { return around(minus(place, s.centre), {}); }
  Curvature operator()(const Capsule& s) const {
    const Vec3 axis = minus(s.to, s.from), from = minus(place, s.from);
    const double length = norm(axis), along = length > 0 ? dot(from, axis) / length : 0;
    if (along <= 0) return around(from, {});
    if (along >= length) return around(minus(place, s.to), {});
    return side(axis, from);
  }
  Curvature operator()(const Cylinder& s) const {
    const Nearest found = nearest(s, place);
    const Vec3 axis = minus(s.to, s.from);
    return std::abs(dot(found.normal, axis)) < 1e-9 * norm(axis) ? side(axis, minus(place, s.from))
                                                                 : Curvature{};
  }
  template <class Flat>
  Curvature operator()(const Flat&) const {
    return {};
  }
  static Curvature side(const Vec3& axis, const Vec3& from) {
    const Vec3 straight = scaled(1 / norm(axis), axis);
    return around(minus(from, scaled(dot(from, straight), straight)), straight);
  }
};

}  // namespace

Curvature curvature(const Shape& shape, const Vec3& place) {
  return std::visit(CurvatureAt{place}, shape);
}

}  // namespace suture
