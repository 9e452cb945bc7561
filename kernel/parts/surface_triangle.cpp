// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/surface_triangle.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "kernel/base/archive.hpp"
#include "kernel/parts/cube_sides.hpp"

namespace suture {
namespace {

/// The reference coordinates of a point that depends on nodes of an element only.
Vec3 place_of(const EmbeddedPoints& points, Index p, const Hexahedron& nodes) {
  Vec3 place{};
  for (Index i = points.first[p]; i < points.first[p + 1]; ++i) {
    const auto node = std::ranges::find(nodes, points.vertices[i]) - nodes.begin();
    place = plus(place, scaled(points.weights[i], corner_place(static_cast<std::size_t>(node))));
  }
  return place;
}

struct GaussPoint {
  double at, weight;  ///< on [0, 1]
};
/// Gauss and Legendre's rule of degree 9.
std::array<GaussPoint, 5> gauss_points() {
  const double root = std::sqrt(10. / 7), near = std::sqrt(5 - 2 * root) / 6,
               far = std::sqrt(5 + 2 * root) / 6;
  const double heavy = (322 + 13 * std::sqrt(70.)) / 1800,
               light = (322 - 13 * std::sqrt(70.)) / 1800;
  return {{{0.5 - far, light},
           {0.5 - near, heavy},
           {0.5, 64. / 225},
           {0.5 + near, heavy},
           {0.5 + far, light}}};
}

/// The derivative of the weights of the nodes at a place in a direction.
std::array<double, 8> weights_along(const Vec3& at, const Vec3& direction) {
  std::array<double, 8> derivative{};
  for (std::size_t n = 0; n < 8; ++n)
    for (std::size_t a = 0; a < 3; ++a) {
      double product = (n >> a & 1) != 0 ? direction[a] / 2 : -direction[a] / 2;
      for (std::size_t b = 0; b < 3; ++b)
        if (b != a) product *= ((n >> b & 1) != 0 ? 1 + at[b] : 1 - at[b]) / 2;
      derivative[n] += product;
    }
  return derivative;
}

}  // namespace

SurfaceTriangle surface_triangle(const Embedding& embedding, Index t, const CellComplex& complex) {
  SurfaceTriangle triangle{embedding.triangle_element[t], {}};
  const Hexahedron& nodes = complex.vertices_of(triangle.element);
  for (std::size_t i = 0; i < 3; ++i)
    triangle.corners[i] = place_of(embedding.points, embedding.triangles[t][i], nodes);
  return triangle;
}

std::vector<SurfaceTriangle> triangles_of_faces(std::span<const Dart> faces) {
  std::vector<SurfaceTriangle> triangles;
  for (const Dart face : faces) {
    const auto [a, b, c, d] = corners_of(cube_sides[cube_side_of(face)]);
    const Vec3 first = corner_place(a), middle = corner_place(c);
    triangles.push_back({element_of(face), {first, corner_place(b), middle}});
    triangles.push_back({element_of(face), {first, middle, corner_place(d)}});
  }
  return triangles;
}

namespace {

constexpr double piece_rounding = 1e-9;

double twice_area_of(const std::array<Vec3, 3>& t) {
  return norm(cross(minus(t[1], t[0]), minus(t[2], t[0])));
}

/// Adds to `found` the piece of a triangle that lies in another one of the same plane, in
/// triangles. Returns twice its area.
double add_piece(const SurfaceTriangle& triangle, const SurfaceTriangle& large,
                 std::vector<SurfaceTriangle>& found) {
  const auto& [a, b, c] = large.corners;
  const Vec3 normal = cross(minus(b, a), minus(c, a));
  const double size = norm(normal);
  for (const Vec3& corner : triangle.corners)
    if (std::abs(dot(minus(corner, a), normal)) > piece_rounding * size) return 0;
  std::vector<Vec3> polygon(triangle.corners.begin(), triangle.corners.end());
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &from = large.corners[i], along = minus(large.corners[(i + 1) % 3], from);
    const auto height = [&](const Vec3& p) { return dot(cross(along, minus(p, from)), normal); };
    std::vector<Vec3> inside;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Vec3 &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
      const double at_p = height(p), at_q = height(q);
      if (at_p >= 0) inside.push_back(p);
      if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0))
        inside.push_back(plus(p, scaled(at_p / (at_p - at_q), minus(q, p))));
    }
    polygon = std::move(inside);
  }
  double area = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const std::array<Vec3, 3> piece{polygon[0], polygon[i - 1], polygon[i]};
    if (!(twice_area_of(piece) > piece_rounding * twice_area_of(triangle.corners))) continue;
    area += twice_area_of(piece);
    found.push_back({triangle.element, piece});
  }
  return area;
}

/// visit(triangle) for what part i has of the surface of its element: triangles that no blade made,
/// and those on sides, where the material touches them.
template <class Visit>
void for_each_outer_triangle(const Parts& parts, Visit visit) {
  const auto triangle = [&](Index element, Index a, Index b, Index c) {
    return SurfaceTriangle{element, {parts.points[a].at, parts.points[b].at, parts.points[c].at}};
  };
  const auto sides = [](const SurfaceTriangle& of) {
    return sides_at(of.corners[0]) & sides_at(of.corners[1]) & sides_at(of.corners[2]);
  };
  for (std::size_t t = 0; t < parts.triangles.size(); ++t) {
    const auto& [a, b, c] = parts.triangles[t];
    const SurfaceTriangle of = triangle(parts.points[a].element, a, b, c);
    if (parts.is_cut[t] == 0 && sides(of) == 0) visit(of);
  }
  for (std::size_t i = 0; i < parts.elements.size(); ++i)
    for (Index t = parts.first[i]; t < parts.first[i + 1]; ++t)
      for (const auto& [a, b, c] : tetrahedron_faces) {
        const auto& corners = parts.tetrahedra[t];
        const SurfaceTriangle of = triangle(parts.elements[i], corners[a], corners[b], corners[c]);
        if (sides(of) != 0) visit(of);
      }
}

}  // namespace

std::vector<SurfaceTriangle> triangles_of_copies(std::span<const SurfaceTriangle> triangles,
                                                 const Parts& parts,
                                                 std::span<const Split> copies) {
  std::multimap<Index, const SurfaceTriangle*> of_element;
  for (const SurfaceTriangle& triangle : triangles) of_element.emplace(triangle.element, &triangle);
  std::vector<SurfaceTriangle> found;
  std::vector<Split> by_copy(copies.begin(), copies.end());
  std::ranges::stable_sort(by_copy, {}, &Split::new_cell);
  for_each_outer_triangle(parts, [&](const SurfaceTriangle& triangle) {
    const std::size_t before = found.size();
    double area = 0;
    auto copy = std::ranges::lower_bound(by_copy, triangle.element, {}, &Split::new_cell);
    for (; copy != by_copy.end() && copy->new_cell == triangle.element; ++copy) {
      const auto [first, last] = of_element.equal_range(copy->old_cell);
      for (auto entry = first; entry != last; ++entry)
        area += add_piece(triangle, *entry->second, found);
    }
    if (area == 0 || area < (1 - piece_rounding) * twice_area_of(triangle.corners)) return;
    found.resize(before);  // it lies in them as a whole
    found.push_back(triangle);
  });
  std::ranges::stable_sort(found, {}, &SurfaceTriangle::element);
  return found;
}

void state_of(Archive& archive, std::vector<SurfaceTriangle>& triangles) {
  archive.group("triangles", [&] {
    archive.member("element", triangles, &SurfaceTriangle::element);
    archive.member("corners", triangles, &SurfaceTriangle::corners);
  });
}

/// In the unit square, of which one side is collapsed to a corner: s = (1 - r) q.
std::vector<TrianglePoint> quadrature_points(const SurfaceTriangle& triangle) {
  static const std::array<GaussPoint, 5> gauss = gauss_points();
  const auto& [a, b, c] = triangle.corners;
  const Vec3 along_r = minus(b, a), along_s = minus(c, a);
  std::vector<TrianglePoint> points;
  for (const GaussPoint& r : gauss)
    for (const GaussPoint& q : gauss) {
      const Vec3 at = plus(a, plus(scaled(r.at, along_r), scaled((1 - r.at) * q.at, along_s)));
      points.push_back({(1 - r.at) * r.weight * q.weight, trilinear_weights(at),
                        weights_along(at, along_r), weights_along(at, along_s)});
    }
  return points;
}

}  // namespace suture
