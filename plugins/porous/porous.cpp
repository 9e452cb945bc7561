// SPDX-License-Identifier: MIT
#include "suture/continuum.hpp"

/// A solid whose pores are full of a fluid; equations in README.md.
struct Porous : suture::continuum<Porous> {
  static constexpr const char
      *id = "porous",
      *doc = "Neo-Hookean solid with pores full of a fluid (Biot)",
      *formula =
          "P = dW/dF - alpha p cof F, S dp/dt + alpha dJ/dt = div(k grad p), "
          "W = mu/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)^2",
      *citation =
          "M. A. Biot, J. Applied Physics 12, 1941, 155-164; J. A. White, "
          "R. I. Borja, CMAME 197, 2008, 4353-4366; J. Kim, H. A. Tchelepi, "
          "R. Juanes, SPE Journal 16, 2011, 249-262";
  enum { mu, lambda, rho, mobility, alpha, storage };
  static constexpr suture::parameter parameters[] = {
      suture::number("mu", "Pa", "Shear modulus of the drained solid").above(0),
      suture::number("lambda", "Pa", "First Lame constant of the drained solid").at_least(0),
      suture::number("rho", "kg/m^3", "Density of solid and fluid together").above(0),
      suture::number("k", "m^2/(Pa s)", "Permeability over the viscosity of the fluid").above(0),
      suture::number("alpha", "1", "Coefficient of Biot").at_least(0).at_most(1).or_else(1),
      suture::number("S", "1/Pa", "Fluid that a volume takes up per pressure")
          .at_least(0)
          .or_else(0)};
  static double density(const suture::values& p) { return p[rho]; }
  static double capacity(const suture::values& p) { return p[storage]; }
  /// alpha^2 over the stiffness to pressure, between those of a free and of an infinite body.
  static double relaxation(const suture::values& p) {
    const double free = p[lambda] + 2.0 / 3 * p[mu], infinite = p[lambda] + 2 * p[mu];
    return p[alpha] * p[alpha] * 0.5 * (1 / free + 1 / infinite);
  }

  static constexpr suture::attribute vertex_fields[] = {
      suture::vertex_field("pressure", "Pa", "Pressure of the fluid"),
      suture::lumped_capacity<Porous>("fluid_capacity", "m^3/Pa",
                                      "An eighth of S V of every incident element"),
      suture::lumped_relaxation<Porous>("drained_compliance", "m^3/Pa",
                                        "What the solid gives way per pressure"),
      suture::rate_of_field("pressure_rate", "Pa/s", "Change of the pressure")};

  template <class T, class P, class At>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const P& p, const At& at) {
    const T change = excess_J(F), ln_j = log1p(change);
    return 0.5 * p[mu] * (excess_I1(F) - 2.0 * ln_j) + 0.5 * p[lambda] * (ln_j * ln_j) -
           p[alpha] * at.field[0] * change;
  }
  /// By the flow, and by the second term of the source.
  template <class P, class At>
  static auto dissipation(const P& p, const At& at) {
    return p[mobility] * dot(at.gradient, at.gradient) +
           smoothing(p) * at.field * (at.rate - at.mean_rate);
  }
  template <class P>
  static double smoothing(const P& p) {
    return 3 * p[alpha] * p[alpha] / (p[lambda] + 2 * p[mu]);
  }
  /// The second term of the source keeps the pressures of neighbours from alternating where the
  /// fluid cannot flow: the projection of White and Borja, with the factor of Aguilar et al., which
  /// makes them monotone in a column.
  template <class F, class P, class At>
  static auto release(const F& f, const P& p, const At& at) {
    const auto swelling = dot(cofactor(f), at.dF);  // dJ/dt
    return suture::released{-p[alpha] * swelling - smoothing(p) * (at.rate - at.mean_rate),
                            at.gradient * -p[mobility]};
  }
};

SUTURE_PLUGIN("porous", "0.1.0", "MIT", "Porous solid full of a fluid", Porous)
