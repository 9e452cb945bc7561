// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/clip.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/parts/cut_patterns.hpp"
#include "kernel/parts/moments.hpp"

namespace suture {
namespace {

constexpr int box_sides = 6;

/// How far a point lies on the inner side of side 2 a (the low one of axis a) or 2 a + 1.
double depth(const Vec3& p, const Box& box, int side) {
  const auto axis = static_cast<std::size_t>(side / 2);
  return side % 2 == 0 ? p[axis] - box.low[axis] : box.high[axis] - p[axis];
}

Vec3 between(const Vec3& a, const Vec3& b, double share) {
  Vec3 p;
  for (std::size_t c = 0; c < 3; ++c) p[c] = a[c] + share * (b[c] - a[c]);
  return p;
}

/// Tetrahedra are clipped into tetrahedra, side by side of the box.
double clipped_volume(std::array<Vec3, 4> t, const Box& box, int side) {
  std::array<double, 4> d{};
  int inside = 0;
  for (; side < box_sides; ++side) {
    inside = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      d[i] = depth(t[i], box, side);
      inside += d[i] > 0 ? 1 : 0;
    }
    if (inside == 0) return 0;
    if (inside < 4) break;
  }
  if (side == box_sides) return std::abs(six_volumes(t)) / 6;
  for (std::size_t i = 0, first = 0; i < 4; ++i) {  // inner corners first
    if (!(d[i] > 0)) continue;
    std::swap(t[i], t[first]);
    std::swap(d[i], d[first++]);
  }

  // cut(i, j): where the edge between an inner and an outer one leaves.
  const auto cut = [&](std::size_t i, std::size_t j) {
    return between(t[i], t[j], d[i] / (d[i] - d[j]));
  };
  const auto of = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& e) {
    return clipped_volume({a, b, c, e}, box, side + 1);
  };
  // A wedge between the triangles a b c and e f g.
  const auto of_wedge = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& e,
                            const Vec3& f, const Vec3& g) {
    return of(a, b, c, e) + of(b, c, e, f) + of(c, e, f, g);
  };
  if (inside == 1) return of(t[0], cut(0, 1), cut(0, 2), cut(0, 3));
  if (inside == 2) return of_wedge(t[0], cut(0, 2), cut(0, 3), t[1], cut(1, 2), cut(1, 3));
  return of_wedge(t[0], t[1], t[2], cut(0, 3), cut(1, 3), cut(2, 3));
}

}  // namespace

double volume_within(const std::array<Vec3, 4>& tetrahedron, const Box& box) {
  return clipped_volume(tetrahedron, box, 0);
}

std::array<std::array<Vec3, 4>, 6> tetrahedra_of(const std::array<Vec3, 8>& corners) {
  const CutPattern& whole = cut_pattern(all_corners);
  std::array<std::array<Vec3, 4>, 6> result;
  for (std::size_t t = 0; t < 6; ++t)
    for (std::size_t i = 0; i < 4; ++i)
      result[t][i] = corners[low_corner(whole.points[whole.tetrahedra[t][i]])];
  return result;
}

bool meets(std::vector<Vec3> polygon, const Box& box) {
  std::vector<Vec3> rest;
  for (int side = 0; side < box_sides && !polygon.empty(); ++side) {
    rest.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double from = depth(a, box, side), to = depth(b, box, side);
      if (from >= 0) rest.push_back(a);
      if ((from > 0 && to < 0) || (from < 0 && to > 0))
        rest.push_back(between(a, b, from / (from - to)));
    }
    std::swap(polygon, rest);
  }
  return !polygon.empty();
}

}  // namespace suture
