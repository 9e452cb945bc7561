// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <vector>

namespace suture::test {

/// A law of continuum.hpp in closed form, with the parameters for which it holds.
struct Law {
  const char* model;
  std::vector<double> parameters;                       ///< all but the last, the element
  Eigen::Matrix3d (*stress)(const Eigen::Matrix3d& F);  ///< first Piola-Kirchhoff, Pa
  double (*energy)(const Eigen::Matrix3d& F);           ///< J/m^3
};

namespace law {

using Eigen::Matrix3d;

constexpr double mu = 2e5, lambda = 3e5;  // Pa
constexpr double young = mu * (3 * lambda + 2 * mu) / (lambda + mu),
                 poisson = lambda / (2 * (lambda + mu));
constexpr double c10 = 5e4, c01 = 2e4, bulk = 1e6;
constexpr double k1 = 1e5, k2 = 1.5;

inline Matrix3d inverse_transpose(const Matrix3d& F) { return F.inverse().transpose(); }

inline Matrix3d neo_hookean(const Matrix3d& F, double shear) {
  return shear * F + (lambda * std::log(F.determinant()) - shear) * inverse_transpose(F);
}
inline double neo_hookean_energy(const Matrix3d& F, double shear) {
  const double ln_j = std::log(F.determinant());
  return shear / 2 * (F.squaredNorm() - 3) - shear * ln_j + lambda / 2 * ln_j * ln_j;
}

inline Matrix3d mooney_rivlin(const Matrix3d& F) {
  const Matrix3d C = F.transpose() * F, back = inverse_transpose(F);
  const double J = F.determinant(), I1 = C.trace(), I2 = (I1 * I1 - (C * C).trace()) / 2;
  return c10 * std::pow(J, -2 / 3.) * (2 * F - 2 / 3. * I1 * back) +
         c01 * std::pow(J, -4 / 3.) * (2 * I1 * F - 2 * F * C - 4 / 3. * I2 * back) +
         bulk * (J - 1) * J * back;
}
inline double mooney_rivlin_energy(const Matrix3d& F) {
  const Matrix3d C = F.transpose() * F;
  const double J = F.determinant(), I1 = C.trace(), I2 = (I1 * I1 - (C * C).trace()) / 2;
  return c10 * (std::pow(J, -2 / 3.) * I1 - 3) + c01 * (std::pow(J, -4 / 3.) * I2 - 3) +
         bulk / 2 * (J - 1) * (J - 1);
}

inline Matrix3d hooke(const Matrix3d& F) {
  const Matrix3d e = (F + F.transpose()) / 2 - Matrix3d::Identity();
  return lambda * e.trace() * Matrix3d::Identity() + 2 * mu * e;
}
inline double hooke_energy(const Matrix3d& F) {
  const Matrix3d e = (F + F.transpose()) / 2 - Matrix3d::Identity();
  return lambda / 2 * e.trace() * e.trace() + mu * e.squaredNorm();
}

/// Hooke's law in the frame of the rotation of F, by singular values.
inline Matrix3d rotation(const Matrix3d& F) {
  const Eigen::JacobiSVD<Matrix3d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}
inline Matrix3d corotational(const Matrix3d& F) {
  return rotation(F) * hooke(rotation(F).transpose() * F);
}
inline double corotational_energy(const Matrix3d& F) {
  return hooke_energy(rotation(F).transpose() * F);
}

/// Fibres along (1, 1, 1); they carry no compression.
inline Eigen::Vector3d fibre() { return Eigen::Vector3d::Constant(1 / std::sqrt(3)); }
inline double fibre_strain(const Matrix3d& F) {
  return std::max((F * fibre()).squaredNorm() - 1, 0.0);
}
inline Matrix3d fibres(const Matrix3d& F) {
  const double J = F.determinant(), e = fibre_strain(F);
  return mu * F + (lambda * (J - 1) * J - mu) * inverse_transpose(F) +
         2 * k1 * e * std::exp(k2 * e * e) * (F * fibre()) * fibre().transpose();
}
inline double fibres_energy(const Matrix3d& F) {
  const double J = F.determinant(), e = fibre_strain(F);
  return mu / 2 * (F.squaredNorm() - 3) - mu * std::log(J) + lambda / 2 * (J - 1) * (J - 1) +
         k1 / (2 * k2) * (std::exp(k2 * e * e) - 1);
}

/// The power law K t^-n / Gamma(1 - n), and its relaxation times.
constexpr double stiffness = 861, exponent = 0.1138, shortest = 1e-3;
/// Moduli of the terms with the relaxation times shortest 10^k; from k = 5 on they are elastic.
inline double term(int k) {
  return stiffness * std::log(10) / (std::tgamma(1 - exponent) * std::tgamma(exponent)) *
         std::pow(shortest * std::pow(10, k), -exponent);
}
inline double elastic_modulus() {
  double sum = 0;
  for (int k = 5; k < 300; ++k) sum += term(k);
  return sum;
}
inline double instantaneous_modulus() {
  double sum = elastic_modulus();
  for (int k = 0; k < 5; ++k) sum += term(k);
  return sum;
}

}  // namespace law

inline const std::vector<Law>& laws() {
  using namespace law;
  static const std::vector<Law> list{
      {"neo-hookean",
       {young, poisson, 1000},
       [](const Matrix3d& F) { return neo_hookean(F, mu); },
       [](const Matrix3d& F) { return neo_hookean_energy(F, mu); }},
      {"mooney-rivlin", {c10, c01, bulk, 1000}, mooney_rivlin, mooney_rivlin_energy},
      {"hooke", {young, poisson, 1000}, hooke, hooke_energy},
      {"corotational", {young, poisson, 1000}, corotational, corotational_energy},
      {"fibres", {mu, lambda, k1, k2, 1000, 1 / std::sqrt(3)}, fibres, fibres_energy},
      {"visco",  // before it has relaxed
       {stiffness, exponent, lambda, 1000, shortest},
       [](const Matrix3d& F) { return neo_hookean(F, instantaneous_modulus()); },
       [](const Matrix3d& F) { return neo_hookean_energy(F, instantaneous_modulus()); }}};
  return list;
}

}  // namespace suture::test
