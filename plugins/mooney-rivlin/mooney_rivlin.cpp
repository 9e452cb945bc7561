// SPDX-License-Identifier: MIT
#include "suture/continuum.hpp"

/// Nearly incompressible Mooney-Rivlin solid from its energy alone; equations in README.md.
struct MooneyRivlin : suture::continuum<MooneyRivlin> {
  static constexpr const char* id = "mooney-rivlin";
  static constexpr const char* doc = "Nearly incompressible Mooney-Rivlin solid on hexahedra";
  static constexpr const char* formula =
      "W = C10 (J^(-2/3) I1 - 3) + C01 (J^(-4/3) I2 - 3) + K/2 (J - 1)^2, I1 = tr C, "
      "I2 = ((tr C)^2 - tr C^2)/2, C = F'F";
  static constexpr const char* citation =
      "G. A. Holzapfel: Nonlinear Solid Mechanics, 2000, section 6.5";

  enum { c10, c01, bulk, rho };
  static constexpr suture::parameter parameters[] = {
      suture::number("C10", "Pa", "Coefficient of I1; the shear modulus is 2 (C10 + C01)")
          .above(0)
          .per_element(),
      suture::number("C01", "Pa", "Coefficient of I2").at_least(0).per_element(),
      suture::number("K", "Pa", "Bulk modulus at rest").above(0).per_element(),
      suture::number("rho", "kg/m^3", "Density of the rest shape").above(0).per_element()};
  template <class P>
  static auto density(const P& p) {
    return p[rho];
  }

  template <class T, class Parameters>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const Parameters& p) {
    const auto e = isochoric(excess_invariants(F));
    return p[c10] * e.I1 + p[c01] * e.I2 + 0.5 * p[bulk] * (e.J * e.J);
  }
};

SUTURE_PLUGIN("mooney-rivlin", "0.1.0", "MIT", "Mooney-Rivlin solid", MooneyRivlin)
