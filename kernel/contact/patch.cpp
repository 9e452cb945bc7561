// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/patch.hpp"

#include <algorithm>

#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

constexpr int iterations = 2;

std::array<double, 4> weights_at(double r, double s) {
  return {(1 - r) * (1 - s), r * (1 - s), r * s, (1 - r) * s};
}

Vec3 sum(const std::array<double, 4>& weights, const std::array<Vec3, 4>& points) {
  Vec3 total{};
  for (std::size_t i = 0; i < 4; ++i) total = plus(total, scaled(weights[i], points[i]));
  return total;
}

/// Towards the minimum of |offset - a dr - b ds| within the square. On a side, the other coordinate
/// has a minimum of its own.
void improve(double& r, double& s, const Vec3& a, const Vec3& b, const Vec3& offset) {
  const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b);
  const double fa = dot(a, offset), fb = dot(b, offset), det = aa * bb - ab * ab;
  if (!(det > 0)) return;
  const double free_r = r + (bb * fa - ab * fb) / det, free_s = s + (aa * fb - ab * fa) / det;
  double to_r = std::clamp(free_r, 0.0, 1.0), to_s = std::clamp(free_s, 0.0, 1.0);
  if (to_r != free_r)
    to_s = std::clamp(s + (fb - ab * (to_r - r)) / bb, 0.0, 1.0);
  else if (to_s != free_s)
    to_r = std::clamp(r + (fa - ab * (to_s - s)) / aa, 0.0, 1.0);
  r = to_r;
  s = to_s;
}

}  // namespace

Vec3 Patch::centre() const { return sum({0.25, 0.25, 0.25, 0.25}, corners); }

bool Patch::may_be_within(double distance, const Vec3& place) const {
  for (std::size_t c = 0; c < 3; ++c) {
    const auto [low, high] =
        std::minmax({corners[0][c], corners[1][c], corners[2][c], corners[3][c]});
    if (place[c] < low - distance || place[c] > high + distance) return false;
  }
  return true;
}

bool Patch::is_in_front(const Vec3& place, const Vec3& normal, double distance) const {
  return std::ranges::all_of(
      corners, [&](const Vec3& corner) { return dot(normal, minus(place, corner)) > distance; });
}

/// x(r, s) = p0 + r e + s f + r s w.
Patch::Foot Patch::foot(const Vec3& place) const {
  const Vec3 e = minus(corners[1], corners[0]), f = minus(corners[3], corners[0]);
  const Vec3 w = minus(minus(corners[2], corners[1]), f), from_first = minus(place, corners[0]);
  double r = 0.5, s = 0.5;
  Foot foot{};
  Vec3 a{}, b{};
  for (int i = 0; i <= iterations; ++i) {
    a = plus(e, scaled(s, w));
    b = plus(f, scaled(r, w));
    foot.offset = minus(minus(from_first, scaled(r, a)), scaled(s, f));
    if (i < iterations) improve(r, s, a, b, foot.offset);
  }
  foot.weights = weights_at(r, s);
  const Vec3 normal = cross(a, b);
  const double length = norm(normal);
  foot.normal = length > 0 ? scaled(1 / length, normal) : Vec3{0, 0, 1};
  return foot;
}

}  // namespace suture
