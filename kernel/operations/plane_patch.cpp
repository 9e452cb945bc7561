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

double distance_of_segment(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 side = minus(b, a), offset = minus(p, a);
  const double squared = dot(side, side);
  const double t = squared == 0 ? 0 : std::clamp(dot(offset, side) / squared, 0.0, 1.0);
  return norm(minus(offset, scaled(t, side)));
}

bool is_near_polygon(const PlanePatch& patch, const Vec3& p, double reach) {
  for (std::size_t i = 0; i < patch.polygon.size(); ++i)
    if (distance_of_segment(patch.polygon[i], patch.polygon[(i + 1) % patch.polygon.size()], p) <=
        reach)
      return true;
  return false;
}

/// A face between two elements, with what decides whether a patch cuts it.
class FaceAcross {
 public:
  FaceAcross(const CellComplex& complex, const double* rows, std::size_t stride, Dart face)
      : one(centroid(complex.vertices_of(element_of(face)), rows, stride)),
        other(centroid(complex.vertices_of(element_of(complex.beta3(face))), rows, stride)) {
    for (Dart k = 0; k < 4; ++k) {
      const double* x = rows + stride * complex.origin(face_of(face) + k);
      corners_[k] = {x[0], x[1], x[2]};
    }
  }
  double reach() const {
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 4; ++k)
      shortest = std::min(shortest, norm(minus(corners_[(k + 1) % 4], corners_[k])));
    return reach_in_edges * shortest;
  }
  /// Of its projection onto the plane; negative where the surface of faces folds back.
  CutArea area_on(const PlanePatch& patch) const {
    std::array<Vec3, 4> flat;
    std::ranges::transform(corners_, flat.begin(), [&](const Vec3& x) {
      const double height = dot(patch.normal, minus(x, patch.point));
      return minus(x, scaled(height / dot(patch.normal, patch.normal), patch.normal));
    });
    CutArea area;
    for (const Corners3& triangle :
         {Corners3{flat[0], flat[1], flat[2]}, {flat[0], flat[2], flat[3]}})
      area += {area_of(triangle),
               held_area(triangle, [&](const Vec3& p) { return is_inside(patch, p); })};
    const Vec3 normal = cross(minus(corners_[2], corners_[0]), minus(corners_[3], corners_[1]));
    const Vec3 link = minus(other, one);
    const double sign =
        dot(normal, link) * dot(normal, patch.normal) * dot(link, patch.normal) < 0 ? -1 : 1;
    return {sign * area.opened, sign * area.blade};
  }
  Vec3 one, other;  ///< the centroids of the elements

 private:
  std::array<Vec3, 4> corners_;
};

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

bool is_inside(const PlanePatch& patch, const Vec3& p, double reach) {
  const Vec3 r = minus(p, patch.point);
  const double radius = patch.radius + reach;
  if (!(dot(r, r) <= radius * radius)) return false;
  return patch.polygon.empty() || is_in_polygon(patch, p) ||
         (reach > 0 && is_near_polygon(patch, p, reach));
}

std::vector<Dart> faces_across_patch(const CellComplex& complex, const double* rows,
                                     const PlanePatch& patch, std::size_t stride,
                                     const ElementBlocks* blocks, CutArea* area) {
  std::vector<Dart> faces = faces_across_plane(complex, rows, patch.point, patch.normal, stride,
                                               blocks, box_around(patch));
  if (std::isinf(patch.radius) && patch.polygon.empty()) return faces;
  std::erase_if(faces, [&](Dart face) {
    const FaceAcross across(complex, rows, stride, face);
    const bool is_cut = is_inside(patch, crossing(patch, across.one, across.other), across.reach());
    if (area) {
      const CutArea own = across.area_on(patch);
      *area += {is_cut ? own.opened : 0, own.blade};
    }
    return !is_cut;
  });
  return faces;
}

}  // namespace suture
