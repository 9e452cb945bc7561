// SPDX-License-Identifier: MIT
#include "suture/isotropic_law.hpp"

/// Linear elasticity in the rotated frame of the element; equations in README.md.
struct Corotational : suture::isotropic_law<Corotational> {
  static constexpr const char* id = "corotational";
  static constexpr const char* doc = "Linear elastic solid for large rotations and small strains";
  static constexpr const char* formula =
      "W = mu |F - R|^2 + lambda/2 (R:F - 3)^2, F = R U; P = 2 mu (F - R) + lambda (R:F - 3) R";
  static constexpr const char* citation =
      "M. Mueller, M. Gross: Interactive Virtual Materials, Graphics Interface 2004";

  template <class T, class C>
  static T energy(const suture::mat3<T>& F, const C& c) {
    const auto R = polar_rotation(F), D = F - R;
    const T stretch = dot(R, F) - 3.0;
    return c.mu * dot(D, D) + 0.5 * c.lambda * (stretch * stretch);
  }
  template <class T, class C>
  static suture::mat3<T> stress(const suture::mat3<T>& F, const C& c) {
    const auto R = polar_rotation(F);
    return (2.0 * c.mu) * (F - R) + R * (c.lambda * (dot(R, F) - 3.0));
  }
};

SUTURE_PLUGIN("corotational", "0.1.0", "MIT", "Corotational elastic solid", Corotational)
