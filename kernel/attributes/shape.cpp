// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/shape.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/topology/hexahedron_tables.hpp"

namespace suture {
namespace {

Vec3 operator-(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vec3 operator+(const Vec3& a, const Vec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

double triple(const Vec3& a, const Vec3& b, const Vec3& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

}  // namespace

bool is_parallelepiped(const HexahedronNodes& x) {
  double size2 = 0;
  for (const int i : {1, 2, 4}) {
    const Vec3 edge = x[static_cast<std::size_t>(i)] - x[0];
    size2 = std::max(size2, edge[0] * edge[0] + edge[1] * edge[1] + edge[2] * edge[2]);
  }
  const double tolerance = 1e-12 * std::sqrt(size2);
  for (std::size_t edge = 0; edge < hexahedron::edges; ++edge) {
    const auto [a, b] = hexahedron::edge_vertices[edge];
    const auto [p, q] = hexahedron::edge_vertices[edge / 4 * 4];
    const Vec3 difference = (x[b] - x[a]) - (x[q] - x[p]);
    for (const double d : difference)
      if (!(std::abs(d) <= tolerance)) return false;
  }
  return true;
}

bool is_box(const HexahedronNodes& x) {
  for (std::size_t d = 0; d < 3; ++d) {
    std::array<Vec3, 4> edges;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto [a, b] = hexahedron::edge_vertices[4 * d + i];
      edges[i] = x[b] - x[a];
    }
    const Vec3 sum = (edges[0] + edges[1]) + (edges[2] + edges[3]);
    if (sum[(d + 1) % 3] != 0 || sum[(d + 2) % 3] != 0) return false;
  }
  return true;
}

double hexahedron_volume(const HexahedronNodes& x) {
  const std::array<Vec3, 8> v = {x[0], x[1], x[3], x[2], x[4], x[5], x[7], x[6]};
  return (triple((v[3] - v[1]) + (v[7] - v[2]), v[6] - v[3], v[2] - v[0]) +
          triple((v[4] - v[3]) + (v[5] - v[7]), v[6] - v[4], v[7] - v[0]) +
          triple((v[1] - v[4]) + (v[2] - v[5]), v[6] - v[1], v[5] - v[0])) /
         12;
}

}  // namespace suture
