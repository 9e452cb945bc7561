// SPDX-License-Identifier: MIT
#include "suture/continuum.hpp"

/// Compressible neo-Hookean solid from its energy alone; equations in README.md.
struct NeoHookean : suture::continuum<NeoHookean> {
  static constexpr const char* id = "neo-hookean";
  static constexpr const char* doc = "Compressible neo-Hookean solid on hexahedra";
  static constexpr const char* formula = "W = mu/2 (F:F - 3) - mu ln J + lambda/2 (ln J)^2";
  static constexpr const char* citation =
      "J. Bonet, R. D. Wood: Nonlinear Continuum Mechanics for Finite Element Analysis, 2nd "
      "edition, 2008, eq. 6.27";

  enum { young, poisson, rho };
  static constexpr suture::parameter parameters[] = {
      suture::number("E", "Pa", "Young's modulus at rest").above(0).per_element(),
      suture::number("nu", "1", "Poisson's ratio at rest").above(-1).below(0.5).per_element(),
      suture::number("rho", "kg/m^3", "Density of the rest shape").above(0).per_element()};

  template <class R>
  using Constants = suture::lame_of<R>;
  static void prepare(const suture::setup& p, suture::lame& c) {
    c = suture::lame_constants(p[young], p[poisson]);
  }
  template <class P>
  static auto density(const P& p) {
    return p[rho];
  }

  template <class T, class C>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const C& c) {
    const T ln_j = log1p(excess_J(F));
    return 0.5 * c.mu * (excess_I1(F) - 2.0 * ln_j) + 0.5 * c.lambda * ln_j * ln_j;
  }
};

SUTURE_PLUGIN("neo-hookean", "0.1.0", "MIT", "Compressible neo-Hookean solid", NeoHookean)
