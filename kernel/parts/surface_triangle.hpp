// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/base/vec3.hpp"
#include "kernel/parts/embedding.hpp"

namespace suture {

class Archive;

/// A triangle of the embedded surface. It is flat in the reference cube of its element and moves
/// with it: where faces of elements warp, so does the triangle.
struct SurfaceTriangle {
  Index element;
  std::array<Vec3, 3> corners;  ///< reference coordinates, counterclockwise as seen from outside
};

/// Triangle t of an embedding.
SurfaceTriangle surface_triangle(const Embedding& embedding, Index t, const CellComplex& complex);

/// Two for each face of a full element.
std::vector<SurfaceTriangle> triangles_of_faces(std::span<const Dart> faces);

/// What `triangles` have become in a cut along a blade, on the copies of their elements, or where
/// copies have absorbed their elements (TopologyChange::successors()). `parts`: of the copies.
/// O(parts log n).
std::vector<SurfaceTriangle> triangles_of_copies(std::span<const SurfaceTriangle> triangles,
                                                 const Parts& parts, std::span<const Split> copies);

void state_of(Archive& archive, std::vector<SurfaceTriangle>& triangles);

/// A point of a triangle, given by coordinates r, s: 0 <= r, s and r + s <= 1.
struct TrianglePoint {
  double weight;                      ///< the weights of the points sum to 1/2
  std::array<double, 8> n, n_r, n_s;  ///< of the nodes of the element: x = sum n x_a

  /// Where it is if the nodes of its element are at x, m.
  Vec3 place(const std::array<Vec3, 8>& x) const { return sum(n, x); }
  /// dx/dr x dx/ds there, outward, m^2.
  Vec3 area(const std::array<Vec3, 8>& x) const { return cross(sum(n_r, x), sum(n_s, x)); }

 private:
  static Vec3 sum(const std::array<double, 8>& factors, const std::array<Vec3, 8>& x) {
    Vec3 total{};
    for (std::size_t a = 0; a < x.size(); ++a) total = plus(total, scaled(factors[a], x[a]));
    return total;
  }
};
/// The points of a quadrature of degree 7: exact for a product of shape functions and area vectors.
/// dx/dr x dx/ds points outward.
std::vector<TrianglePoint> quadrature_points(const SurfaceTriangle& triangle);

}  // namespace suture
