// SPDX-License-Identifier: MIT
#include "suture/continuum.hpp"

struct Tissue : suture::continuum<Tissue> {
  static constexpr const char *id = "tissue", *doc = "Soft tissue that stiffens exponentially",
                              *formula = "W = a/(2b) (exp(b (I1 - 3)) - 1) + K/2 (J - 1)^2",
                              *citation = "H. Demiray, J. Biomech. 5, 1972, 309";
  enum { a, b, bulk, rho };
  static constexpr suture::parameter parameters[] = {
      suture::number("a", "Pa", "Shear modulus at rest").above(0),
      suture::number("b", "1", "How fast it stiffens").above(0),
      suture::number("K", "Pa", "Bulk modulus").above(0),
      suture::number("rho", "kg/m^3", "Density").above(0)};
  static double density(const suture::values& p) { return p[rho]; }

  template <class T, class P>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const P& p) {
    const T J = det(F), excess = dot(F, F) / cbrt(J * J) - 3.0;
    return 0.5 * p[a] / p[b] * (exp(p[b] * excess) - 1.0) + 0.5 * p[bulk] * ((J - 1.0) * (J - 1.0));
  }
};
SUTURE_PLUGIN("tissue", "1.0", "MIT", "Demiray's law of soft tissue", Tissue)
