// SPDX-License-Identifier: GPL-3.0-or-later
#include "suture/continuum.hpp"

/// A neo-Hookean matrix with fibres that resist stretching; the law reads the parameters of each
/// element directly.
struct Fibres : suture::continuum<Fibres> {
  static constexpr const char *id = "fibres-of-test", *doc = "Neo-Hookean matrix with fibres",
                              *formula = "W = mu/2 (F:F - 3) - mu ln J + k/4 (|F a|^2 - 1)^2",
                              *citation = "textbook";
  enum { mu, k, rho, fibre };
  static constexpr suture::parameter parameters[] = {
      suture::number("mu", "Pa", "Shear modulus").above(0).per_element(),
      suture::number("k", "Pa", "Stiffness of the fibres").at_least(0).per_element(),
      suture::number("rho", "kg/m^3", "Density").above(0),
      suture::direction("fibre", "Direction of the fibres at rest")};
  template <class P>
  static auto density(const P& p) {
    return p[rho];
  }
  template <class T, class P>
  static T energy(const suture::mat3<T>& F, const P& p) {
    const auto a = F * p.direction(fibre);
    const T stretch = dot(a, a) - 1.0;
    return 0.5 * p[mu] * (dot(F, F) - 3) - p[mu] * log(det(F)) + 0.25 * p[k] * (stretch * stretch);
  }
};
SUTURE_PLUGIN("fibres-of-test", "1.0", "MIT", "Fibres with directions from the mesh", Fibres)
