// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/swept_gap.hpp"

#include <algorithm>
#include <optional>

#include "kernel/base/rows.hpp"

namespace suture {
namespace {

// Parts of the length of a way: what is nearer to a convex shape touches it; the shortest step
// along the surface of another one; how far outside a place on the surface is taken to be.
constexpr double touching = 1e-9, shortest_step = 1. / 256, outside = 1e-6;
constexpr int max_steps = 64, max_steps_to_triangles = 512;

/// Where a way enters a shape.
struct Entry {
  Vec3 place;
  Nearest there;
};

class Sweep {
 public:
  Sweep(const Shape& shape, double offset)
      : shape_(shape),
        offset_(offset),
        is_convex_(!std::holds_alternative<Triangulated>(shape)),
        max_steps_(is_convex_ ? max_steps : max_steps_to_triangles) {}

  Nearest gap(const Vec3& place) const {
    Nearest found = nearest(shape_, place);
    found.distance -= offset_;
    return found;
  }

  /// A convex shape lies behind the plane through its nearest point, so the way is free up to that
  /// plane; another shape is at least as far away as its nearest point.
  std::optional<Entry> first_entry(const Vec3& from, const Vec3& to) const {
    const double length = norm(minus(to, from));
    const Vec3 along = scaled(1 / length, minus(to, from));
    const double close = is_convex_ ? touching * length : shortest_step * length;
    double done = 0;
    for (int i = 0; i < max_steps_ && done < length; ++i) {
      const Vec3 place = plus(from, scaled(done, along));
      const Nearest here = gap(place);
      const double closing = -dot(here.normal, along);
      if (closing > 0 && here.distance <= (is_convex_ ? close : closing * close))
        return Entry{place, here};
      if (is_convex_ && !(closing > 0)) return {};
      done += is_convex_ ? here.distance / closing : std::max(here.distance, close);
    }
    return {};
  }

  /// Where a way between two places outside goes in, if it comes out on a side that faces away.
  std::optional<Entry> passage(const Vec3& from, const Vec3& to) const {
    const std::optional<Entry> in = first_entry(from, to);
    if (!in) return {};
    const std::optional<Entry> out = first_entry(to, in->place);
    return out && dot(in->there.normal, out->there.normal) <= 0 ? in : std::nullopt;
  }

 private:
  const Shape& shape_;
  double offset_;
  bool is_convex_;
  int max_steps_;
};

}  // namespace

Nearest swept_gap(const Shape& shape, double offset, const Vec3& from, const Vec3& to) {
  const Sweep sweep(shape, offset);
  const Nearest end = sweep.gap(to);
  Vec3 out = to;
  if (end.distance <= 0) {
    const double lift = outside * norm(minus(to, from)) - end.distance;
    out = plus(to, scaled(lift, end.normal));
  }
  const std::optional<Entry> in = sweep.passage(from, out);
  if (!in) return end;
  return {in->there.distance + dot(minus(to, in->place), in->there.normal), in->there.normal};
}

}  // namespace suture
