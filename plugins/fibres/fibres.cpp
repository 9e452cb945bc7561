// SPDX-License-Identifier: MIT
#include "suture/continuum.hpp"

/// A neo-Hookean matrix with fibres that stiffen exponentially; equations in README.md.
struct Fibres : suture::continuum<Fibres> {
  static constexpr const char* id = "fibres";
  static constexpr const char* doc = "Neo-Hookean solid with fibres that stiffen as they stretch";
  static constexpr const char* formula =
      "W = mu/2 (F:F - 3) - mu ln J + lambda/2 (J - 1)^2 + k1/(2 k2) (exp(k2 <I4 - 1>^2) - 1), "
      "I4 = |F a|^2";
  static constexpr const char* citation =
      "G. A. Holzapfel, T. C. Gasser, R. W. Ogden, J. Elasticity 61, 2000, 1-48";

  enum { mu, lambda, k1, k2, rho, fibre };
  static constexpr suture::parameter parameters[] = {
      suture::number("mu", "Pa", "Shear modulus of the matrix").above(0).per_element(),
      suture::number("lambda", "Pa", "First Lame constant").at_least(0).per_element(),
      suture::number("k1", "Pa", "Stiffness of the fibres").at_least(0).per_element(),
      suture::number("k2", "1", "How fast the fibres stiffen").above(0).per_element(),
      suture::number("rho", "kg/m^3", "Density of the rest shape").above(0).per_element(),
      suture::direction("fibre", "Direction a of the fibres at rest")};
  template <class P>
  static auto density(const P& p) {
    return p[rho];
  }

  template <class T, class P>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const P& p) {
    const auto a = F * p.direction(fibre);
    const T stretch = max(dot(a, a) - 1.0, T(0.0)), change = excess_J(F);
    return 0.5 * p[mu] * (excess_I1(F) - 2.0 * log1p(change)) +
           0.5 * p[lambda] * (change * change) +
           0.5 * p[k1] / p[k2] * expm1(p[k2] * (stretch * stretch));
  }
};

SUTURE_PLUGIN("fibres", "0.1.0", "MIT", "Fibre-reinforced solid", Fibres)
