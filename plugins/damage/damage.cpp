// SPDX-License-Identifier: MIT
#include "suture/continuum.hpp"

/// A neo-Hookean solid that weakens for good; equations in README.md.
struct Damage : suture::continuum<Damage> {
  static constexpr const char *id = "damage", *doc = "Neo-Hookean solid that weakens with strain",
                              *formula =
                                  "W = (1 - d) W0, d = 1 - (e0/m) exp((e0 - m)/e1), m the "
                                  "largest of e0 and every sqrt(2 W0 / mu) so far",
                              *citation = "Simo, Ju, Int. J. Solids Structures 23, 1987, 821-840";
  enum { mu, lambda, rho, e0, e1 };
  static constexpr suture::parameter parameters[] = {
      suture::number("mu", "Pa", "Shear modulus").above(0),
      suture::number("lambda", "Pa", "First Lame constant").at_least(0),
      suture::number("rho", "kg/m^3", "Density of the rest shape").above(0),
      suture::number("e0", "1", "Strain at which damage begins").above(0),
      suture::number("e1", "1", "Strain over which the stiffness falls by a factor e").above(0)};
  static double density(const suture::values& p) { return p[rho]; }
  template <class T>
  struct State {
    T largest;
  };
  static constexpr suture::attribute states[] = {
      suture::state("largest", "1", "Largest equivalent strain so far", 1)};
  template <class T, class P>
  static SUTURE_INLINE T intact(const suture::mat3<T>& F, const P& p) {
    const T ln_j = log1p(excess_J(F));
    return 0.5 * p[mu] * (excess_I1(F) - 2.0 * ln_j) + 0.5 * p[lambda] * (ln_j * ln_j);
  }
  template <class T, class P, class At>
  static void evolve(const suture::mat3<T>& F, const P& p, At& at) {
    const T square = max(2.0 / p[mu] * intact(F, p), T(p[e0] * p[e0]));
    at.state.largest = max(sqrt(square), at.state.largest);
  }
  template <class T, class P, class At>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const P& p, const At& at) {
    return p[e0] / at.state.largest * exp((p[e0] - at.state.largest) / p[e1]) * intact(F, p);
  }
};
SUTURE_PLUGIN("damage", "0.1.0", "MIT", "Elastic solid with damage", Damage)
