// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "kernel/attributes/shape.hpp"
#include "kernel/forces/symmetric3.hpp"
#include "kernel/topology/hexahedron_tables.hpp"

namespace suture {

/// The axis of the pair of opposite faces that a face belongs to, and the two faces.
inline constexpr std::array<int, 6> axis_of_face{0, 1, 0, 1, 2, 2};
inline constexpr std::array<std::array<int, 2>, 3> faces_of_axis{{{0, 2}, {1, 3}, {4, 5}}};

/// A_a: mean of the four edge vectors along each axis, m.
inline std::array<Vec3, 3> mean_edges(const HexahedronNodes& x) {
  std::array<Vec3, 3> mean{};
  for (std::size_t e = 0; e < 12; ++e) {
    const auto [a, b] = hexahedron::edge_vertices[e];
    for (std::size_t c = 0; c < 3; ++c) mean[e / 4][c] += (x[b][c] - x[a][c]) / 4;
  }
  return mean;
}

/// G_a with A_a . G_b = 1 if a = b, else 0: normal to the faces across axis a, 1/m.
/// Not finite if the mean edges lie in a plane.
inline std::array<Vec3, 3> reciprocals(const std::array<Vec3, 3>& A) {
  std::array<Vec3, 3> G;
  const auto cross = [](const Vec3& a, const Vec3& b) {
    return Vec3{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  for (std::size_t a = 0; a < 3; ++a) G[a] = cross(A[(a + 1) % 3], A[(a + 2) % 3]);
  const double volume = A[0][0] * G[0][0] + A[0][1] * G[0][1] + A[0][2] * G[0][2];
  for (Vec3& g : G)
    for (double& component : g) component /= volume;
  return G;
}

/// The value of an element, and the axis across whose faces it applies.
struct AxisValue {
  double value;
  int axis;
};

/// Largest principal Green-Lagrange strain at the centre, and the axis across whose
/// faces the element is strained the most:
///   E = (F^T F - 1) / 2,   F = sum_a A_a x G_a,   axis: largest G_a . E G_a / |G_a|^2
inline AxisValue principal_strain(const HexahedronNodes& x, const std::array<Vec3, 3>& G) {
  const std::array<Vec3, 3> A = mean_edges(x);
  double F[3][3], E[3][3];
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      F[i][j] = A[0][i] * G[0][j] + A[1][i] * G[1][j] + A[2][i] * G[2][j];
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      E[i][j] = (F[0][i] * F[0][j] + F[1][i] * F[1][j] + F[2][i] * F[2][j] - (i == j)) / 2;
  AxisValue result{largest_eigenvalue({E[0][0], E[1][1], E[2][2], E[0][1], E[1][2], E[0][2]}), 0};
  double most = -1;
  for (std::size_t a = 0; a < 3; ++a) {
    double across = 0, size = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      size += G[a][i] * G[a][i];
      for (std::size_t j = 0; j < 3; ++j) across += G[a][i] * E[i][j] * G[a][j];
    }
    if (a > 0 && !(across / size > most)) continue;
    most = across / size;
    result.axis = static_cast<int>(a);
  }
  return result;
}

inline double edge_length(const HexahedronNodes& x, std::size_t edge) {
  const auto [a, b] = hexahedron::edge_vertices[edge];
  return std::hypot(x[b][0] - x[a][0], x[b][1] - x[a][1], x[b][2] - x[a][2]);
}

/// Per axis the largest l/L - 1 of its four edges.
inline std::array<double, 3> elongations(const HexahedronNodes& x, const HexahedronNodes& rest) {
  std::array<double, 3> most{-1, -1, -1};
  for (std::size_t e = 0; e < 12; ++e)
    most[e / 4] = std::max(most[e / 4], edge_length(x, e) / edge_length(rest, e) - 1);
  return most;
}

}  // namespace suture
