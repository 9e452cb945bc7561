// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/blade.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

// How far from the blade distances are known, in edges: all corners of an element that it crosses,
// and of its neighbours.
constexpr double known_within = 3.5;

Vec3 place_of(const double* rows, std::size_t stride, Index v) {
  const double* x = rows + stride * v;
  return {x[0], x[1], x[2]};
}

/// Files may repeat the points of each triangle.
TriangleSurface with_shared_points(TriangleSurface surface) {
  std::vector<Index> order(surface.points.size()), number(order.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::sort(order, {}, [&](Index p) { return surface.points[p]; });
  std::vector<Vec3> points;
  for (const Index p : order) {
    if (points.empty() || points.back() != surface.points[p]) points.push_back(surface.points[p]);
    number[p] = static_cast<Index>(points.size() - 1);
  }
  for (Triangle& t : surface.triangles)
    for (Index& corner : t) corner = number[corner];
  surface.points = std::move(points);
  return surface;
}

}  // namespace

double longest_edge(const CellComplex& complex, const double* rows, std::size_t stride) {
  double longest = 0;
  for (Index e = 0; e < complex.element_count(); ++e) {
    if (!complex.exists(3, e)) continue;
    const Hexahedron& nodes = complex.vertices_of(e);
    for (const auto& [a, b] : hexahedron::edge_vertices) {
      const Vec3 edge = minus(place_of(rows, stride, nodes[a]), place_of(rows, stride, nodes[b]));
      longest = std::max(longest, dot(edge, edge));
    }
  }
  return std::sqrt(longest);
}

std::vector<double> PlaneBlade::heights(const CellComplex& complex, const double* rows,
                                        std::size_t stride) const {
  const Vec3 n = scaled(1 / norm(patch_.normal), patch_.normal);
  std::vector<double> heights(complex.count(0));
  for (Index v = 0; v < heights.size(); ++v)
    if (complex.exists(0, v)) heights[v] = dot(n, minus(place_of(rows, stride, v), patch_.point));
  return heights;
}

bool PlaneBlade::is_endless() const { return std::isinf(patch_.radius) && patch_.polygon.empty(); }

SurfacePatch::SurfacePatch(TriangleSurface surface, const Vec3& origin)
    : surface_(with_shared_points(std::move(surface))) {
  if (const std::string fault = surface_.fault(origin); !fault.empty())
    throw InputError(this->surface().source + ": " + fault +
                     ", so the blade has no two sides; give all of its triangles the same "
                     "orientation, or cut along \"faces\"");
}

SurfacePatch::SurfacePatch(TriangleSurface surface, double longest_edge)
    : surface_(std::move(surface)), longest_edge_(longest_edge) {}

std::vector<double> SurfacePatch::heights(const CellComplex& complex, const double* rows,
                                          std::size_t stride) const {
  const double within =
      known_within * (longest_edge_ > 0 ? longest_edge_ : longest_edge(complex, rows, stride));
  const Box box = box_of(surface().points);
  return heights_in({&box, 1}, within, complex, rows, stride, within);
}

bool SurfacePatch::holds(const Vec3& place, double reach) const {
  const OrientedSurface::Foot foot = surface_.foot(place);
  if (!foot.is_on_border) return true;
  const Vec3 away = minus(place, foot.point);
  const double height = dot(away, foot.normal) / dot(foot.normal, foot.normal);
  return norm(minus(away, scaled(height, foot.normal))) <= reach;
}

std::vector<double> SurfacePatch::heights_in(std::span<const Box> boxes, double margin,
                                             const CellComplex& complex, const double* rows,
                                             std::size_t stride, double within) const {
  const Box surface_box = box_of(surface().points);
  const double size = norm(minus(surface_box.high, surface_box.low));
  Box all = no_box;
  for (const Box& box : boxes)
    for (const Vec3& corner : {box.low, box.high}) include(all, corner);
  const auto is_near = [&](const Vec3& place) {
    return contains(all, place, margin) &&
           std::ranges::any_of(boxes, [&](const Box& box) { return contains(box, place, margin); });
  };
  std::vector<double> heights(complex.count(0), std::numeric_limits<double>::quiet_NaN());
  Index last = 0;
  for (Index v = 0; v < heights.size(); ++v) {
    if (!complex.exists(0, v)) continue;
    const Vec3 place = place_of(rows, stride, v);
    if (!is_near(place)) continue;
    const auto foot = surface_.foot_within(place, within, last);
    if (!foot) continue;
    last = foot->triangle;
    const Nearest nearest = OrientedSurface::distance(*foot, place, 1e-12 * size);
    // Beyond the rim it goes on: so do the sections of the elements in front of it.
    heights[v] = foot->is_on_border
                     ? dot(minus(place, foot->point), foot->normal) / norm(foot->normal)
                     : nearest.distance;
  }
  return heights;
}

}  // namespace suture
