// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>

#include "kernel/attributes/attributes.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/topology/seam.hpp"

// Loaded faces: bilinear, with four corners.

namespace suture {

using Quad = std::array<Vec3, 4>;

/// Vertices of the face of a dart, counterclockwise as seen from inside: the normal dx/dr x dx/ds
/// points inward.
inline std::array<Index, 4> face_nodes(const CellComplex& complex, Dart face) {
  const Hexahedron& x = complex.vertices_of(element_of(face));
  const auto& local = suture_hexahedron_faces[local_face(face)];
  return {x[local[0]], x[local[1]], x[local[2]], x[local[3]]};
}

/// A point of a bilinear face on the unit square, nodes (0,0) (1,0) (1,1) (0,1).
struct QuadPoint {
  std::array<double, 4> n, n_r, n_s;  ///< shape functions and their derivatives
  Vec3 x_r{}, x_s{};                  ///< dx/dr and dx/ds
  Vec3 normal() const { return cross(x_r, x_s); }
  Vec3 place(const Quad& x) const {
    Vec3 sum{};
    for (std::size_t a = 0; a < 4; ++a) sum = plus(sum, scaled(n[a], x[a]));
    return sum;
  }
};

/// visit(point) at the 2 x 2 Gauss points of a face; weights 1/4.
template <class Visit>
void for_each_point(const Quad& x, Visit visit) {
  const double low = 0.5 - 0.5 / std::sqrt(3.0), points[2] = {low, 1 - low};
  for (const double r : points)
    for (const double s : points) {
      QuadPoint point{{(1 - r) * (1 - s), r * (1 - s), r * s, (1 - r) * s},
                      {s - 1, 1 - s, s, -s},
                      {r - 1, -r, r, 1 - r}};
      for (std::size_t c = 0; c < 3; ++c) {
        point.x_r[c] = (1 - s) * (x[1][c] - x[0][c]) + s * (x[2][c] - x[3][c]);
        point.x_s[c] = (1 - r) * (x[3][c] - x[0][c]) + r * (x[2][c] - x[1][c]);
      }
      visit(point);
    }
}

/// rows[vertex] += s force, if the vertex is live.
inline void add_row(double* rows, const LiveMask& live, Index vertex, double s, const Vec3& force) {
  for (std::size_t c = 0; c < 3 && live[vertex]; ++c)
    rows[std::size_t{vertex} * 4 + c] += s * force[c];
}

}  // namespace suture
