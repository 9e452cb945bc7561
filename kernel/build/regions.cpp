// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/regions.hpp"

namespace suture {
namespace {

double tolerance_of(const Selection::Plane& plane, double diagonal) {
  return plane.tolerance < 0 ? Selection::default_tolerance * diagonal : plane.tolerance;
}

// Whether a point lies in a geometric selection. `diagonal`: of the mesh, m.
struct Contains {
  const Vec3& p;
  double diagonal;
  bool operator()(const Selection::All&) const { return true; }
  bool operator()(const Selection::InBox& b) const {
    for (int a = 0; a < 3; ++a) {
      if (p[a] < b.min[a] || p[a] > b.max[a]) return false;
    }
    return true;
  }
  bool operator()(const Selection::Plane& s) const {
    return std::abs(dot(minus(p, s.point), s.normal)) <= tolerance_of(s, diagonal) * norm(s.normal);
  }
  bool operator()(const Selection::HalfSpace& s) const {
    return dot(minus(p, s.point), s.normal) >= 0;
  }
  bool operator()(const Selection::Sphere& s) const { return norm(minus(p, s.centre)) <= s.radius; }
  bool operator()(const Selection::Cylinder& s) const {
    const Vec3 axis = minus(s.to, s.from), r = minus(p, s.from);
    const double length = norm(axis), along = dot(r, axis) / length, slack = 1e-14 * length;
    return along >= -slack && along <= length + slack && norm(cross(r, axis)) <= s.radius * length;
  }
  bool operator()(const Selection::Combined& s) const {
    const auto holds = [&](const Selection& part) { return std::visit(*this, part.what); };
    if (s.how == Selection::Combined::How::all_of) return std::ranges::all_of(s.parts, holds);
    return std::ranges::any_of(s.parts, holds) != (s.how == Selection::Combined::How::none_of);
  }
  bool operator()(const Selection::Nearest&) const { return false; }
  bool operator()(const Selection::Ids&) const { return false; }
  bool operator()(const Selection::Named&) const { return false; }
};

/// False only if no point of a box lies in a geometric selection.
struct MayHold {
  const Box& box;
  double diagonal;
  bool operator()(const Selection::All&) const { return true; }
  bool operator()(const Selection::InBox& b) const { return overlap(box, {b.min, b.max}); }
  bool operator()(const Selection::Plane& s) const {
    const auto [low, high] = heights_of(box, s.point, s.normal);
    const double reach = tolerance_of(s, diagonal) * norm(s.normal);
    return low <= reach && high >= -reach;
  }
  bool operator()(const Selection::HalfSpace& s) const {
    return heights_of(box, s.point, s.normal)[1] >= 0;
  }
  bool operator()(const Selection::Sphere& s) const {
    return least_distance(box, s.centre) <= s.radius;
  }
  bool operator()(const Selection::Cylinder& s) const {
    Box around{s.from, s.from};
    include(around, s.to);
    for (std::size_t a = 0; a < 3; ++a) around.low[a] -= s.radius, around.high[a] += s.radius;
    return overlap(box, around);
  }
  bool operator()(const Selection::Combined& s) const {
    const auto may_hold = [&](const Selection& part) { return std::visit(*this, part.what); };
    if (s.how == Selection::Combined::How::all_of) return std::ranges::all_of(s.parts, may_hold);
    return s.how == Selection::Combined::How::none_of || std::ranges::any_of(s.parts, may_hold);
  }
  bool operator()(const Selection::Nearest&) const { return false; }
  bool operator()(const Selection::Ids&) const { return false; }
  bool operator()(const Selection::Named&) const { return false; }
};

}  // namespace

bool lies_in(const Selection& region, const Vec3& p, double diagonal) {
  return std::visit(Contains{p, diagonal}, region.what);
}

bool may_hold_some(const Selection& region, const Box& box, double diagonal) {
  return std::visit(MayHold{box, diagonal}, region.what);
}

}  // namespace suture
