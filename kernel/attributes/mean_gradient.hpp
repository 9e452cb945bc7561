// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/attributes/shape.hpp"
#include "kernel/base/types.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/mesh/parts.hpp"
#include "kernel/topology/hexahedron_tables.hpp"

// The deformation gradient of a trilinear hexahedron at its centre,
//   F = sum_a A_a x G_a,
// with A_a the mean of the four edges along axis a and G_a the reciprocal of those at rest. If only
// a part of the element is material, the edges are means over it in local coordinates, and F is the
// mean gradient if the element is a parallelepiped.

namespace suture {

/// A symmetric tensor: XX YY ZZ XY YZ XZ, the order of VTK.
using SymmetricTensor = std::array<double, 6>;

/// A_a: mean of the four edge vectors along each axis, m.
inline std::array<Vec3, 3> mean_edges(const HexahedronNodes& x) {
  std::array<Vec3, 3> mean{};
  for (std::size_t e = 0; e < hexahedron::edges; ++e) {
    const auto [a, b] = hexahedron::edge_vertices[e];
    for (std::size_t c = 0; c < 3; ++c) mean[e / 4][c] += (x[b][c] - x[a][c]) / 4;
  }
  return mean;
}

/// The same with the gradient of the material, the mean over its part of the element; null: all of
/// the element. With the moments in [-1, 1]^3 and the sums of hourglasses h_yz = sum s_y s_z x_n,
///   A_x + (mean_y h_xy + mean_z h_xz + mean_yz h_xyz) / 4
/// and likewise for y and z.
inline std::array<Vec3, 3> mean_edges(const HexahedronNodes& x, const PartMoments* part) {
  std::array<Vec3, 3> A = mean_edges(x);
  if (part == nullptr) return A;
  std::array<Vec3, 4> h{};  // yz, xz, xy, xyz
  for (std::size_t n = 0; n < 8; ++n) {
    const double s[3] = {n & 1 ? 1.0 : -1.0, n & 2 ? 1.0 : -1.0, n & 4 ? 1.0 : -1.0};
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t a = 0; a < 3; ++a) h[a][c] += s[(a + 1) % 3] * s[(a + 2) % 3] * x[n][c];
      h[3][c] += s[0] * s[1] * s[2] * x[n][c];
    }
  }
  const Vec3& mean = part->centroid;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3, d = (a + 2) % 3;
    const double both = part->covariance[a] + mean[b] * mean[d];
    for (std::size_t c = 0; c < 3; ++c)
      A[a][c] += (mean[b] * h[d][c] + mean[d] * h[b][c] + both * h[3][c]) / 4;
  }
  return A;
}

/// A_x . (A_y x A_z), m^3
inline double determinant(const std::array<Vec3, 3>& A) { return dot(A[0], cross(A[1], A[2])); }

/// G_a with A_a . G_b = 1 if a = b, else 0: normal to the faces across axis a, 1/m.
/// Not finite if the mean edges lie in a plane.
inline std::array<Vec3, 3> reciprocals(const std::array<Vec3, 3>& A) {
  std::array<Vec3, 3> G;
  for (std::size_t a = 0; a < 3; ++a) G[a] = cross(A[(a + 1) % 3], A[(a + 2) % 3]);
  const double volume = dot(A[0], G[0]);
  for (Vec3& g : G)
    for (double& component : g) component /= volume;
  return G;
}

/// The rows of F; `G`: reciprocals() of the mean edges at rest, of the same part. `part`: as for
/// mean_edges().
inline std::array<Vec3, 3> mean_gradient(const HexahedronNodes& x, const std::array<Vec3, 3>& G,
                                         const PartMoments* part = nullptr) {
  const std::array<Vec3, 3> A = mean_edges(x, part);
  std::array<Vec3, 3> F;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      F[i][j] = A[0][i] * G[0][j] + A[1][i] * G[1][j] + A[2][i] * G[2][j];
  return F;
}

/// E = (F^T F - 1) / 2
inline SymmetricTensor green_lagrange(const std::array<Vec3, 3>& F) {
  const auto product = [&](std::size_t i, std::size_t j) {
    return F[0][i] * F[0][j] + F[1][i] * F[1][j] + F[2][i] * F[2][j];
  };
  return {(product(0, 0) - 1) / 2, (product(1, 1) - 1) / 2, (product(2, 2) - 1) / 2,
          product(0, 1) / 2,       product(1, 2) / 2,       product(0, 2) / 2};
}

/// n . E n
inline double along(const SymmetricTensor& E, const Vec3& n) {
  return n[0] * n[0] * E[0] + n[1] * n[1] * E[1] + n[2] * n[2] * E[2] +
         2 * (n[0] * n[1] * E[3] + n[1] * n[2] * E[4] + n[0] * n[2] * E[5]);
}

}  // namespace suture
