// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/rest_shape.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernel/topology/hexahedron_tables.hpp"

namespace suture {
namespace {

double triple(const Vec3& a, const Vec3& b, const Vec3& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// The 12 edge vectors, each along its axis.
std::array<Vec3, 12> edge_vectors(const Corners& x) {
  std::array<Vec3, 12> result;
  for (int i = 0; i < 12; ++i) {
    const auto [a, b] = hexahedron::edge_vertices[i];
    for (int c = 0; c < 3; ++c) result[i][c] = x[b][c] - x[a][c];
  }
  return result;
}

}  // namespace

std::array<double, 8> corner_jacobians(const Corners& x) {
  const std::array<Vec3, 12> edge = edge_vectors(x);
  std::array<double, 8> result;
  for (int i = 0; i < 8; ++i) {
    const int bx = i & 1, by = i >> 1 & 1, bz = i >> 2 & 1;
    result[i] = triple(edge[by + 2 * bz], edge[4 + bx + 2 * bz], edge[8 + bx + 2 * by]);
  }
  return result;
}

std::array<double, 8> gauss_jacobians(const Corners& x) {
  const std::array<Vec3, 12> edge = edge_vectors(x);
  const double near = 0.5 + std::sqrt(1.0 / 12), weight[2] = {near, 1 - near};
  std::array<double, 8> result;
  for (int g = 0; g < 8; ++g) {
    const int bit[3] = {g & 1, g >> 1 & 1, g >> 2 & 1};
    std::array<Vec3, 3> column{};
    for (int axis = 0; axis < 3; ++axis) {
      const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;  // the other two, lower first
      for (int i = 0; i < 4; ++i) {
        const double w = weight[(i & 1) ^ bit[u]] * weight[(i >> 1) ^ bit[v]];
        for (int c = 0; c < 3; ++c) column[axis][c] += w * edge[4 * axis + i][c];
      }
    }
    result[g] = triple(column[0], column[1], column[2]);
  }
  return result;
}

RestShape rest_shape(const Corners& x) {
  const auto smallest = [](const std::array<double, 8>& j) { return *std::ranges::min_element(j); };
  if (smallest(corner_jacobians(x)) > 0) return {};
  RestShape shape;
  Corners turned = x;
  std::array<double, 8> gauss = gauss_jacobians(x);
  if (std::accumulate(gauss.begin(), gauss.end(), 0.0) < 0) {
    shape.mirrored = true;
    mirror(turned);
    gauss = gauss_jacobians(turned);
  }
  shape.inverted = !(smallest(corner_jacobians(turned)) > 0);
  shape.unusable = shape.inverted && !(smallest(gauss) > 0);
  return shape;
}

}  // namespace suture
