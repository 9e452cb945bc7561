// SPDX-License-Identifier: MIT
#include "suture/isotropic_law.hpp"

/// Linear elasticity from its energy; equations in README.md.
struct Hooke : suture::isotropic_law<Hooke> {
  static constexpr const char* id = "hooke";
  static constexpr const char* doc = "Linear elastic solid, for small rotations and strains";
  static constexpr const char* formula =
      "W = lambda/2 (tr e)^2 + mu e:e, e = (F + F')/2 - I; P = lambda tr(e) I + 2 mu e";
  static constexpr const char* citation =
      "S. P. Timoshenko, J. N. Goodier: Theory of Elasticity, 3rd edition, 1970, section 6";
  static constexpr bool survives_inversion = true;
  static constexpr std::uint32_t flags = SUTURE_CONTINUUM | SUTURE_LINEAR;

  template <class T, class C>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const C& c) {
    const auto e = add_diagonal(symmetric(F), -1.0);
    return 0.5 * c.lambda * (trace(e) * trace(e)) + c.mu * dot(e, e);
  }
};

SUTURE_PLUGIN("hooke", "0.1.0", "MIT", "Linear elastic solid", Hooke)
