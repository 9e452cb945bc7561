// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/shape_mesh.hpp"

#include <numbers>

#include "kernel/base/rows.hpp"
#include "kernel/geometry/solid_surface.hpp"

namespace suture {
namespace {

constexpr Index sectors = 32, arc_parts = 8;  // around an axis; of a quarter of a circle

/// Two directions at right angles to an axis of length 1 and to each other.
std::array<Vec3, 2> across(const Vec3& axis) {
  Vec3 other{};
  other[std::abs(axis[0]) < 0.5 ? 0 : 1] = 1;
  const Vec3 first = cross(axis, other);
  const Vec3 unit = scaled(1 / norm(first), first);
  return {unit, cross(axis, unit)};
}

struct ProfilePoint {
  double radius, along;  ///< m, from the start of the axis
};

/// The surface that a profile describes around an axis of length 1; its ends lie on the axis.
ShapeMesh revolve(const Vec3& start, const Vec3& axis, const std::vector<ProfilePoint>& profile) {
  ShapeMesh mesh;
  const auto [u, v] = across(axis);
  for (const ProfilePoint& p : profile)
    for (Index i = 0; i < sectors; ++i) {
      const double angle = 2 * std::numbers::pi * i / sectors;
      const Vec3 out =
          plus(scaled(p.radius * std::cos(angle), u), scaled(p.radius * std::sin(angle), v));
      mesh.points.push_back(plus(plus(start, scaled(p.along, axis)), out));
    }
  for (Index ring = 0; ring + 1 < profile.size(); ++ring)
    for (Index i = 0; i < sectors; ++i) {
      const Index a = ring * sectors + i, b = ring * sectors + (i + 1) % sectors;
      mesh.faces.push_back({a, b, b + sectors, a + sectors});
    }
  return mesh;
}

/// Two half circles of a profile, `length` apart.
std::vector<ProfilePoint> rounded(double radius, double length) {
  std::vector<ProfilePoint> profile;
  for (Index i = 0; i <= 2 * arc_parts; ++i) {
    const double angle = std::numbers::pi * i / (2 * arc_parts);
    profile.push_back(
        {radius * std::sin(angle), (i > arc_parts ? length : 0) - radius * std::cos(angle)});
  }
  return profile;
}

struct MeshOf {
  const Vec3& around;
  double size;

  ShapeMesh operator()(const HalfSpace& s) const {
    const double off = dot(minus(around, s.point), s.normal);
    const Vec3 middle = minus(around, scaled(off, s.normal));
    const auto [u, v] = across(s.normal);
    ShapeMesh mesh;
    for (const auto& [a, b] : {std::array{-1., -1.}, {1., -1.}, {1., 1.}, {-1., 1.}})
      mesh.points.push_back(plus(middle, plus(scaled(a * size, u), scaled(b * size, v))));
    mesh.faces.push_back({0, 1, 2, 3});
    return mesh;
  }
  ShapeMesh operator()(const Sphere& s) const {
    return revolve(s.centre, {0, 0, 1}, rounded(s.radius, 0));
  }
  ShapeMesh operator()(const Capsule& s) const {
    const Vec3 axis = minus(s.to, s.from);
    return revolve(s.from, scaled(1 / norm(axis), axis), rounded(s.radius, norm(axis)));
  }
  ShapeMesh operator()(const Cylinder& s) const {
    const Vec3 axis = minus(s.to, s.from);
    const double length = norm(axis);
    return revolve(s.from, scaled(1 / length, axis),
                   {{0, 0}, {s.radius, 0}, {s.radius, length}, {0, length}});
  }
  ShapeMesh operator()(const Box& s) const {
    ShapeMesh mesh;
    for (unsigned corner = 0; corner < 8; ++corner) {
      Vec3 p;
      for (std::size_t c = 0; c < 3; ++c) p[c] = corner >> c & 1 ? s.high[c] : s.low[c];
      mesh.points.push_back(p);
    }
    mesh.faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                  {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    return mesh;
  }
  ShapeMesh operator()(const Triangulated& s) const {
    ShapeMesh mesh;
    for (const Vec3& p : s.surface->surface().points) mesh.points.push_back(plus(p, s.middle));
    for (const Triangle& t : s.surface->surface().triangles)
      mesh.faces.push_back({t[0], t[1], t[2], none});
    return mesh;
  }
};

}  // namespace

ShapeMesh mesh_of(const Shape& shape, const Vec3& around, double size) {
  return std::visit(MeshOf{around, size}, shape);
}

}  // namespace suture
