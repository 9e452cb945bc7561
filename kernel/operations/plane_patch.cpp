// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/plane_patch.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/base/vec3.hpp"
#include "kernel/geometry/centroid.hpp"

namespace suture {
namespace {

/// Where the segment from a to b meets the plane. One of them may lie on it.
Vec3 crossing(const PlanePatch& patch, const Vec3& a, const Vec3& b) {
  const double above = dot(patch.normal, minus(a, patch.point));
  const double below = dot(patch.normal, minus(b, patch.point));
  const double t = above == below ? 0 : std::clamp(above / (above - below), 0.0, 1.0);
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

/// That of the largest component of the normal.
std::size_t projected_axis(const PlanePatch& patch) {
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (std::abs(patch.normal[a]) > std::abs(patch.normal[axis])) axis = a;
  return axis;
}

/// Even-odd rule in the projection along the largest component of the normal; a
/// side holds its lower end and not its upper, so that neighbours share nothing.
bool is_in_polygon(const PlanePatch& patch, const Vec3& p) {
  const std::size_t drop = projected_axis(patch);
  const std::size_t u = (drop + 1) % 3, v = (drop + 2) % 3;
  bool odd = false;
  for (std::size_t i = 0; i < patch.polygon.size(); ++i) {
    const Vec3& a = patch.polygon[i];
    const Vec3& b = patch.polygon[(i + 1) % patch.polygon.size()];
    if ((a[v] > p[v]) == (b[v] > p[v])) continue;
    // From the lower end, whichever way the side runs, so that neighbours agree to the bit.
    const Vec3 &low = a[v] < b[v] ? a : b, &high = a[v] < b[v] ? b : a;
    odd ^= p[u] < low[u] + (p[v] - low[v]) * (high[u] - low[u]) / (high[v] - low[v]);
  }
  return odd;
}

/// What is_inside() finds inside is in it.
Box box_around(const PlanePatch& patch) {
  Box polygon = no_box, box;
  for (const Vec3& corner : patch.polygon) include(polygon, corner);
  if (patch.polygon.empty()) polygon = everywhere;
  const std::size_t drop = projected_axis(patch);
  polygon.low[drop] = everywhere.low[drop];
  polygon.high[drop] = everywhere.high[drop];
  for (std::size_t a = 0; a < 3; ++a) {
    const double reach = patch.radius + 1e-14 * (patch.radius + std::abs(patch.point[a]));
    box.low[a] = std::max(polygon.low[a], patch.point[a] - reach);
    box.high[a] = std::min(polygon.high[a], patch.point[a] + reach);
  }
  return box;
}

}  // namespace

bool is_inside(const PlanePatch& patch, const Vec3& p) {
  const Vec3 r = minus(p, patch.point);
  if (!(dot(r, r) <= patch.radius * patch.radius)) return false;
  return patch.polygon.empty() || is_in_polygon(patch, p);
}

std::vector<Dart> faces_across_patch(const CellComplex& complex, const double* rows,
                                     const PlanePatch& patch, std::size_t stride,
                                     const ElementBlocks* blocks) {
  std::vector<Dart> faces = faces_across_plane(complex, rows, patch.point, patch.normal, stride,
                                               blocks, box_around(patch));
  if (std::isinf(patch.radius) && patch.polygon.empty()) return faces;
  std::erase_if(faces, [&](Dart face) {
    const Vec3 a = centroid(complex.vertices_of(element_of(face)), rows, stride);
    const Vec3 b = centroid(complex.vertices_of(element_of(complex.beta3(face))), rows, stride);
    return !is_inside(patch, crossing(patch, a, b));
  });
  return faces;
}

}  // namespace suture
