// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/rest_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "kernel/topology/hexahedron_tables.hpp"

namespace suture {
namespace {

TEST(RestShape, GaussJacobiansGiveTheVolumeOfADistortedHexahedron) {
  // Volume by the divergence theorem over the bilinear faces, each by 3x3 Gauss
  // points (exact), against the mean of the Jacobians.
  std::mt19937 random(7);
  std::uniform_real_distribution<double> offset(-0.2, 0.2);
  Corners x;
  for (int i = 0; i < 8; ++i)
    x[i] = {(i & 1) + offset(random), (i >> 1 & 1) + offset(random), (i >> 2 & 1) + offset(random)};
  const double node[3] = {0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)};
  const double weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  double volume = 0;
  for (int f = 0; f < 6; ++f)
    for (int p = 0; p < 3; ++p)
      for (int q = 0; q < 3; ++q) {
        Vec3 at{}, u{}, v{};
        const double s = node[p], t = node[q];
        const double n[4] = {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
        const double ns[4] = {t - 1, 1 - t, t, -t}, nt[4] = {s - 1, -s, s, 1 - s};
        for (int k = 0; k < 4; ++k)
          for (int c = 0; c < 3; ++c) {
            const double value = x[hexahedron::dart_vertex[4 * f + k]][c];
            at[c] += n[k] * value;
            u[c] += ns[k] * value;
            v[c] += nt[k] * value;
          }
        const double flux = at[0] * (u[1] * v[2] - u[2] * v[1]) +
                            at[1] * (u[2] * v[0] - u[0] * v[2]) +
                            at[2] * (u[0] * v[1] - u[1] * v[0]);
        volume -= weight[p] * weight[q] * flux / 3;  // faces turn inward
      }
  double mean = 0;
  for (const double j : gauss_jacobians(x)) mean += j / 8;
  EXPECT_NEAR(mean, volume, 1e-14);
}

}  // namespace
}  // namespace suture
