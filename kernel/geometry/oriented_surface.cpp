// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/oriented_surface.hpp"

#include <algorithm>
#include <cstdint>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/base/radix_sort.hpp"
#include "kernel/base/rows.hpp"
#include "kernel/geometry/surface_tree.hpp"

namespace suture {
namespace {

Vec3 area_vector(const TriangleSurface& s, const Triangle& t) {
  const Vec3& a = s.points[t[0]];
  return cross(minus(s.points[t[1]], a), minus(s.points[t[2]], a));
}

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

std::string text(const Vec3& p) {
  std::ostringstream out;
  out << '(' << p[0] << ", " << p[1] << ", " << p[2] << ')';
  return out.str();
}

}  // namespace

/// One side of a triangle.
struct OrientedSurface::Side {
  std::uint64_t edge;
  Index triangle, number;
};

OrientedSurface::OrientedSurface(TriangleSurface surface) : surface_(std::move(surface)) {
  std::erase_if(surface_.triangles,
                [&](const Triangle& t) { return !(norm(area_vector(surface_, t)) > 0); });
  if (surface_.triangles.empty())
    throw InputError(surface_.source + ": the surface has no triangle with an area");
  make_normals();
  tree_ = std::make_unique<SurfaceTree>(surface_);
}
OrientedSurface::~OrientedSurface() = default;

void OrientedSurface::make_normals() {
  vertex_normals_.resize(surface_.points.size());
  for (const Triangle& t : surface_.triangles) {
    const Vec3 area = area_vector(surface_, t), normal = scaled(1 / norm(area), area);
    face_normals_.push_back(normal);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& corner = surface_.points[t[i]];
      const double angle = angle_between(minus(surface_.points[t[(i + 1) % 3]], corner),
                                         minus(surface_.points[t[(i + 2) % 3]], corner));
      vertex_normals_[t[i]] = plus(vertex_normals_[t[i]], scaled(angle, normal));
    }
  }
  make_edge_normals();
}

void OrientedSurface::make_edge_normals() {
  std::vector<Side> sides, spare;
  sides.reserve(3 * surface_.triangles.size());
  for (Index i = 0; i < surface_.triangles.size(); ++i)
    for (Index side = 0; side < 3; ++side) {
      const Triangle& t = surface_.triangles[i];
      const Index from = t[side], to = t[(side + 1) % 3];
      sides.push_back({std::uint64_t{std::min(from, to)} << 32 | std::max(from, to), i, side});
    }
  radix_sort(sides, spare, [](const Side& side) { return side.edge; });
  edge_normals_.resize(surface_.triangles.size());
  is_border_edge_.resize(surface_.triangles.size());
  is_border_vertex_.resize(surface_.points.size());
  for (auto first = sides.begin(); first != sides.end();) {
    Vec3 sum{};
    auto last = first;
    for (; last != sides.end() && last->edge == first->edge; ++last)
      sum = plus(sum, face_normals_[last->triangle]);
    const bool is_border = last - first == 1;
    if (is_border)
      is_border_vertex_[first->edge >> 32] = is_border_vertex_[first->edge & 0xffffffff] = true;
    for (; first != last; ++first) {
      edge_normals_[first->triangle][first->number] = sum;
      is_border_edge_[first->triangle][first->number] = is_border;
    }
  }
  find_fault(sides);
}

/// Each edge belongs to two triangles at most, which run along it in opposite directions.
void OrientedSurface::find_fault(const std::vector<Side>& sides) {
  const auto from = [&](const Side& side) {
    return surface_.triangles[side.triangle][side.number];
  };
  const auto complain = [&](const Side& side, const std::string& what) {
    const Triangle& t = surface_.triangles[side.triangle];
    fault_ = {what, surface_.points[t[side.number]], surface_.points[t[(side.number + 1) % 3]]};
  };
  for (std::size_t i = 0; i + 1 < sides.size() && fault_.what.empty(); ++i) {
    if (sides[i + 1].edge != sides[i].edge) continue;
    if (i + 2 < sides.size() && sides[i + 2].edge == sides[i].edge)
      complain(sides[i], "three triangles share");
    else if (from(sides[i]) == from(sides[i + 1]))
      complain(sides[i], "triangles with different sides up share");
  }
}

std::string OrientedSurface::fault(const Vec3& origin) const {
  if (fault_.what.empty()) return {};
  return fault_.what + " the edge from " + text(plus(origin, fault_.from)) + " to " +
         text(plus(origin, fault_.to)) + " m";
}

OrientedSurface::Foot OrientedSurface::foot_in(Index triangle, const Vec3& place) const {
  const Triangle& t = surface_.triangles[triangle];
  const Vec3 &a = surface_.points[t[0]], &b = surface_.points[t[1]], &c = surface_.points[t[2]];
  const Weights w = nearest_in(a, b, c, place);
  const Vec3 point = plus(a, plus(scaled(w.b, minus(b, a)), scaled(w.c, minus(c, a))));
  const int zeros = (w.a == 0) + (w.b == 0) + (w.c == 0);
  if (zeros == 2) {
    const Index corner = w.a != 0 ? t[0] : w.b != 0 ? t[1] : t[2];
    return {triangle, surface_.points[corner], vertex_normals_[corner], is_border_vertex_[corner]};
  }
  if (zeros == 0) return {triangle, point, face_normals_[triangle], false};
  const std::size_t edge = w.c == 0 ? 0 : w.a == 0 ? 1 : 2;
  return {triangle, point, edge_normals_[triangle][edge], is_border_edge_[triangle][edge]};
}

OrientedSurface::Foot OrientedSurface::foot(const Vec3& place, Index start) const {
  return foot_in(tree_->nearest(place, start), place);
}

OrientedSurface::Foot OrientedSurface::rough_foot(const Vec3& place, Index start,
                                                  double least_part) const {
  return foot_in(tree_->nearly_nearest(place, start, least_part), place);
}

std::optional<OrientedSurface::Foot> OrientedSurface::foot_within(const Vec3& place, double within,
                                                                  Index start) const {
  const Index triangle = tree_->nearest(place, start, within);
  if (triangle == none) return {};
  return foot_in(triangle, place);
}

Nearest OrientedSurface::distance(const Foot& foot, const Vec3& place, double rounding) {
  const Vec3 away = minus(place, foot.point);
  const double distance = norm(away), height = dot(away, foot.normal);
  if (distance <= rounding) {
    const double length = norm(foot.normal);
    return {height / length, scaled(1 / length, foot.normal)};
  }
  const double side = height < 0 ? -1 : 1;
  return {side * distance, scaled(side / distance, away)};
}

}  // namespace suture
