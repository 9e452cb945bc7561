// SPDX-License-Identifier: MIT
#include "suture/isotropic_law.hpp"

/// Compressible neo-Hookean solid from its energy alone; equations in README.md.
struct NeoHookean : suture::isotropic_law<NeoHookean> {
  static constexpr const char* id = "neo-hookean";
  static constexpr const char* doc = "Compressible neo-Hookean solid on hexahedra";
  static constexpr const char* formula = "W = mu/2 (F:F - 3) - mu ln J + lambda/2 (ln J)^2";
  static constexpr const char* citation =
      "J. Bonet, R. D. Wood: Nonlinear Continuum Mechanics for Finite Element Analysis, 2nd "
      "edition, 2008, eq. 6.27";

  template <class T, class C>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const C& c) {
    const T ln_j = log1p(excess_J(F));
    return 0.5 * c.mu * (excess_I1(F) - 2.0 * ln_j) + 0.5 * c.lambda * ln_j * ln_j;
  }
};

SUTURE_PLUGIN("neo-hookean", "0.1.0", "MIT", "Compressible neo-Hookean solid", NeoHookean)
