// SPDX-License-Identifier: MIT
#include "suture/continuum.hpp"

struct neo_hooke : suture::continuum<neo_hooke> {
  static constexpr const char *id = "neo-hooke", *doc = "Compressible neo-Hookean solid",
                              *formula = "W = mu/2 (F:F - 3) - mu ln J + lambda/2 (ln J)^2",
                              *citation = "Bonet, Wood: Nonlinear Continuum Mechanics, 2008, 6.27";
  enum { mu, lambda, rho };
  static constexpr suture::parameter parameters[] = {
      suture::number("mu", "Pa", "Shear modulus").above(0),
      suture::number("lambda", "Pa", "First Lame constant").at_least(0),
      suture::number("rho", "kg/m^3", "Density").above(0)};
  static double density(const suture::values& p) { return p[rho]; }

  template <class T, class Parameters>
  static T energy(const suture::mat3<T>& F, const Parameters& p) {
    const T ln_j = log(det(F));
    return 0.5 * p[mu] * (dot(F, F) - 3) - p[mu] * ln_j + 0.5 * p[lambda] * ln_j * ln_j;
  }
};
SUTURE_PLUGIN("neo-hooke", "1.0", "MIT", "Neo-Hookean solid", neo_hooke)
