// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/surface_triangle.hpp"

#include <cmath>

namespace suture {
namespace {

Vec3 corner_place(std::size_t corner) {
  return {corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0};
}

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
