// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>

#include "tests/plugins/stvk_reference.hpp"

/// Stiffness at rest of the hexahedron with 21 enhanced strain modes, as in a textbook: B matrix
/// and modes at 2x2x2 points, the modes condensed. It is the oracle for the closed form of the
/// mean-gradient element and shares no code with it.
namespace suture::test {

using Stiffness = Eigen::Matrix<double, 24, 24>;
using Strain = Eigen::Matrix<double, 6, 1>;  // XX YY ZZ, twice XY YZ XZ

inline Strain engineering(const Eigen::Matrix3d& e) {
  Strain s;
  s << e(0, 0), e(1, 1), e(2, 2), 2 * e(0, 1), 2 * e(1, 2), 2 * e(0, 2);
  return s;
}

inline Eigen::Matrix<double, 6, 6> isotropic_tensor(const Stvk& law) {
  Eigen::Matrix<double, 6, 6> C = Eigen::Matrix<double, 6, 6>::Zero();
  C.topLeftCorner<3, 3>().setConstant(law.lambda);
  C.diagonal() += (Strain() << 2, 2, 2, 1, 1, 1).finished() * law.mu;
  return C;
}

/// The 21 modes in local coordinates s in [-1,1]^3: xi_I, xi_I xi_J on the normal strains II;
/// xi_I, xi_J, xi_I xi_K, xi_J xi_K on the shear strains IJ.
inline Eigen::Matrix<double, 6, 21> enhanced_modes(const Eigen::Vector3d& s,
                                                   const Eigen::Matrix3d& map) {
  Eigen::Matrix<double, 6, 21> modes;
  int column = 0;
  const auto add = [&](int i, int j, double value) {
    Eigen::Matrix3d e = Eigen::Matrix3d::Zero();
    e(i, j) = e(j, i) = value;
    modes.col(column++) = engineering(map.transpose() * e * map);
  };
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    for (const double p : {s[i], s[i] * s[j], s[i] * s[k]}) add(i, i, p);
    for (const double p : {s[i], s[j], s[i] * s[k], s[j] * s[k]}) add(i, j, p);
  }
  return modes;
}

struct LocalGradient {
  Eigen::Matrix<double, 8, 3> local;  ///< dN/ds
  Eigen::Matrix3d jacobian;           ///< dX/ds
};
inline LocalGradient local_gradient(const Hexahedron& X, const Eigen::Vector3d& s) {
  LocalGradient g;
  g.jacobian.setZero();
  for (int n = 0; n < 8; ++n)
    for (int d = 0; d < 3; ++d) {
      g.local(n, d) = shape_derivative(n, d, {(1 + s[0]) / 2, (1 + s[1]) / 2, (1 + s[2]) / 2}) / 2;
      for (int c = 0; c < 3; ++c) g.jacobian(c, d) += X[n][c] * g.local(n, d);
    }
  return g;
}

inline Stiffness enhanced_stiffness(const Hexahedron& X, const Stvk& law) {
  const Eigen::Matrix<double, 6, 6> C = isotropic_tensor(law);
  const Eigen::Matrix3d centre = local_gradient(X, Eigen::Vector3d::Zero()).jacobian;
  Stiffness K = Stiffness::Zero();
  Eigen::Matrix<double, 24, 21> coupling = Eigen::Matrix<double, 24, 21>::Zero();
  Eigen::Matrix<double, 21, 21> inner = Eigen::Matrix<double, 21, 21>::Zero();
  for (int p = 0; p < 8; ++p) {
    const Eigen::Vector3d s =
        Eigen::Vector3d(p & 1 ? 1 : -1, p & 2 ? 1 : -1, p & 4 ? 1 : -1) / std::sqrt(3.0);
    const LocalGradient g = local_gradient(X, s);
    const double j = g.jacobian.determinant();
    const Eigen::Matrix<double, 8, 3> gradient = g.local * g.jacobian.inverse();
    Eigen::Matrix<double, 6, 24> B;
    for (int i = 0; i < 24; ++i) {
      Eigen::Matrix3d e = Eigen::Matrix3d::Zero();
      e.row(i % 3) = gradient.row(i / 3);
      B.col(i) = engineering((e + e.transpose()) / 2);
    }
    const auto modes = enhanced_modes(s, centre.inverse());
    K += j * B.transpose() * C * B;
    coupling += centre.determinant() * B.transpose() * C * modes;
    inner += centre.determinant() * centre.determinant() / j * modes.transpose() * C * modes;
  }
  return K - coupling * inner.ldlt().solve(coupling.transpose());
}

}  // namespace suture::test
