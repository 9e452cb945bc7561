// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <vector>

/// St Venant-Kirchhoff on the trilinear hexahedron as in a textbook (Belytschko et al., Nonlinear
/// Finite Elements for Continua and Structures, 2014, ch. 4): shape gradients node by node, one
/// loop per index. It is the oracle for the fast kernel and shares no code with it.
namespace suture::test {

using Point = std::array<double, 3>;
using Hexahedron = std::array<Point, 8>;
using Matrix = std::array<std::array<double, 3>, 3>;

struct Stvk {
  double lambda, mu;
  Stvk(double E, double nu) : lambda(E * nu / ((1 + nu) * (1 - 2 * nu))), mu(E / (2 * (1 + nu))) {}
};

/// Gauss-Legendre on [0,1]: {point, weight}, by Newton on the Legendre polynomial.
inline std::vector<std::array<double, 2>> gauss_rule(int n) {
  std::vector<std::array<double, 2>> rule;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(M_PI * (i + 0.75) / (n + 0.5)), derivative = 0;
    for (int iteration = 0; iteration < 50; ++iteration) {
      double p0 = 1, p1 = x;
      for (int k = 2; k <= n; ++k) {
        const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      derivative = n * (x * p1 - p0) / (x * x - 1);
      x -= p1 / derivative;
    }
    rule.push_back({(1 + x) / 2, 1 / ((1 - x * x) * derivative * derivative)});
  }
  return rule;
}

inline double determinant(const Matrix& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}
inline Matrix inverted(const Matrix& m) {
  Matrix r;
  const double d = determinant(m);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int a = (j + 1) % 3, b = (j + 2) % 3, p = (i + 1) % 3, q = (i + 2) % 3;
      r[i][j] = (m[a][p] * m[b][q] - m[a][q] * m[b][p]) / d;
    }
  return r;
}

/// dN_n/dxi_d at xi.
inline double shape_derivative(int n, int d, const Point& xi) {
  double value = 1;
  for (int a = 0; a < 3; ++a) {
    const bool high = (n >> a) & 1;
    value *= a == d ? (high ? 1 : -1) : (high ? xi[a] : 1 - xi[a]);
  }
  return value;
}

struct ReferenceResult {
  double energy = 0, volume = 0;
  std::array<Point, 8> force{};
};

/// Adds the contribution of one Gauss point.
inline void add_point(const Hexahedron& X, const Hexahedron& x, const Stvk& law, const Point& xi,
                      double weight, ReferenceResult& result) {
  Matrix J{}, gradient_x{}, F{}, E{}, S{}, P{};
  for (int n = 0; n < 8; ++n)
    for (int i = 0; i < 3; ++i)
      for (int d = 0; d < 3; ++d) {
        J[i][d] += X[n][i] * shape_derivative(n, d, xi);
        gradient_x[i][d] += x[n][i] * shape_derivative(n, d, xi);
      }
  const Matrix inverse_j = inverted(J);
  const double w = weight * determinant(J);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int d = 0; d < 3; ++d) F[i][j] += gradient_x[i][d] * inverse_j[d][j];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) E[i][j] += 0.5 * F[k][i] * F[k][j];
      if (i == j) E[i][j] -= 0.5;
    }
  const double trace = E[0][0] + E[1][1] + E[2][2];
  double contraction = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      S[i][j] = 2 * law.mu * E[i][j] + (i == j ? law.lambda * trace : 0);
      contraction += E[i][j] * E[i][j];
    }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) P[i][j] += F[i][k] * S[k][j];
  result.volume += w;
  result.energy += w * (0.5 * law.lambda * trace * trace + law.mu * contraction);
  for (int n = 0; n < 8; ++n)
    for (int j = 0; j < 3; ++j) {
      double gradient = 0;  // dN_n/dX_j
      for (int d = 0; d < 3; ++d) gradient += shape_derivative(n, d, xi) * inverse_j[d][j];
      for (int i = 0; i < 3; ++i) result.force[n][i] -= w * P[i][j] * gradient;
    }
}

/// Energy and forces with `points` Gauss points per axis.
inline ReferenceResult stvk_reference(const Hexahedron& X, const Hexahedron& x, const Stvk& law,
                                      int points) {
  ReferenceResult result;
  const auto rule = gauss_rule(points);
  for (const auto& gx : rule)
    for (const auto& gy : rule)
      for (const auto& gz : rule)
        add_point(X, x, law, {gx[0], gy[0], gz[0]}, gx[1] * gy[1] * gz[1], result);
  return result;
}

}  // namespace suture::test
