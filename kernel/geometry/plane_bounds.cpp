// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/plane_bounds.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3 minus(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
bool finite(const Vec3& a) { return std::isfinite(a[0] + a[1] + a[2]); }

/// Newell's: the sum of cross products of the sides, twice the area vector.
Vec3 area_vector(const std::vector<Vec3>& corners) {
  Vec3 sum{};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = minus(corners[i], corners[0]);
    const Vec3 b = minus(corners[(i + 1) % corners.size()], corners[0]);
    sum[0] += a[1] * b[2] - a[2] * b[1];
    sum[1] += a[2] * b[0] - a[0] * b[2];
    sum[2] += a[0] * b[1] - a[1] * b[0];
  }
  return sum;
}

double size_of(const Box& box) {
  const Vec3 d = minus(box.high, box.low);
  return std::sqrt(dot(d, d));
}

Vec3 unit(const Vec3& v, const char* of) {
  const double size = std::hypot(v[0], v[1], v[2]);
  if (!std::isfinite(size) || size == 0)
    throw InputError(std::string(of) + " needs a finite normal that is not zero");
  return {v[0] / size, v[1] / size, v[2] / size};
}

}  // namespace

PlaneBounds PlaneBounds::disc(const Vec3& centre, const Vec3& normal, double radius) {
  if (!finite(centre)) throw InputError("a disc needs a finite centre");
  if (!(radius > 0) || !std::isfinite(radius))
    throw InputError("a disc needs a radius that is positive and finite");
  PlaneBounds result;
  result.point_ = centre;
  result.normal_ = unit(normal, "a disc");
  result.radius_ = radius;
  return result;
}

PlaneBounds PlaneBounds::polygon(std::vector<Vec3> corners) {
  if (corners.size() < 3)
    throw InputError("a polygon has at least 3 corners, not " + std::to_string(corners.size()));
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (!finite(corners[i]))
      throw InputError("corner " + std::to_string(i) + " of the polygon is not finite");
  const double size = size_of(box_of(corners));
  const Vec3 area = area_vector(corners);
  if (std::hypot(area[0], area[1], area[2]) <= 1e-12 * size * size)
    throw InputError("the corners of the polygon lie on a line, or its area is zero");
  PlaneBounds result;
  result.normal_ = unit(area, "a polygon");
  for (const Vec3& c : corners)
    for (int a = 0; a < 3; ++a) result.point_[a] += c[a] / double(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (std::abs(dot(result.normal_, minus(corners[i], result.point_))) > 1e-6 * size)
      throw InputError("the polygon is not flat: corner " + std::to_string(i) +
                       " does not lie in the plane of the others");
  result.corners_ = std::move(corners);
  return result;
}

Box PlaneBounds::box() const {
  if (radius_ == 0) return box_of(corners_);
  Box box{point_, point_};
  for (int a = 0; a < 3; ++a) {
    const double reach = radius_ * std::sqrt(std::max(0.0, 1 - normal_[a] * normal_[a]));
    box.low[a] -= reach;
    box.high[a] += reach;
  }
  return box;
}

bool PlaneBounds::covers(const Vec3& p) const {
  if (radius_ > 0) {
    const Vec3 d = minus(p, point_);
    return dot(d, d) <= radius_ * radius_;
  }
  // Sides crossed by the ray from p along the first of the two axes (Shimrat 1962).
  int dropped = 0;
  for (int a = 1; a < 3; ++a)
    if (std::abs(normal_[a]) > std::abs(normal_[dropped])) dropped = a;
  const int u = (dropped + 1) % 3, v = (dropped + 2) % 3;
  bool inside = false;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Vec3 &a = corners_[i], &b = corners_[(i + 1) % corners_.size()];
    if ((a[v] <= p[v]) == (b[v] <= p[v])) continue;
    // From the lower end, whichever way the side runs: neighbours must agree.
    const Vec3 &low = a[v] < b[v] ? a : b, &high = a[v] < b[v] ? b : a;
    const double at = low[u] + (p[v] - low[v]) / (high[v] - low[v]) * (high[u] - low[u]);
    inside = inside != (p[u] < at);
  }
  return inside;
}

void PlaneBounds::keep_within(std::vector<Dart>& faces, const CellComplex& complex,
                              const Places& places) const {
  std::erase_if(faces, [&](Dart face) {
    const Index e = face / 24, n = complex.neighbour(e, static_cast<int>(face % 24 / 4));
    const Vec3 a = vec3(centroid_of(complex.vertices_of(e), places));
    const Vec3 b = vec3(centroid_of(complex.vertices_of(n), places));
    const double above = dot(normal_, minus(a, point_)), below = dot(normal_, minus(b, point_));
    const double t = above == below ? 0.5 : std::clamp(above / (above - below), 0.0, 1.0);
    Vec3 crossing;
    for (int i = 0; i < 3; ++i) crossing[i] = a[i] + t * (b[i] - a[i]);
    return !covers(crossing);
  });
}

}  // namespace suture
