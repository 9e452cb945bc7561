// SPDX-License-Identifier: MIT
#include "suture/continuum.hpp"

/// A neo-Hookean solid with a crack that is smeared over a length; equations in README.md.
struct GradientDamage : suture::continuum<GradientDamage> {
  static constexpr const char
      *id = "gradient-damage",
      *doc = "Solid that cracks: a phase field of brittle fracture",
      *formula =
          "W = (max(1 - d, 0)^2 + r) W+ + W- + 3/8 Gc (d/l + l |grad d|^2), "
          "W+ = mu/2 (J^(-2/3) I1 - 3) + U(max(J, 1)), W- = U(min(J, 1)), "
          "U = K/2 ((J^2 - 1)/2 - ln J); d minimises W and never falls",
      *citation =
          "K. Pham, H. Amor, J.-J. Marigo, C. Maurini, Int. J. Damage "
          "Mechanics 20, 2011, 618-652; M. J. Borden et al., CMAME 312, "
          "2016, 130-166";
  enum { mu, bulk, rho, toughness, length, viscosity, residual };
  static constexpr suture::parameter parameters[] = {
      suture::number("mu", "Pa", "Shear modulus of the intact solid").above(0),
      suture::number("K", "Pa", "Bulk modulus of the intact solid").above(0),
      suture::number("rho", "kg/m^3", "Density of the rest shape").above(0),
      suture::number("Gc", "J/m^2", "Energy of a crack per area").above(0),
      suture::number("l", "m", "Length over which a crack is smeared, two elements or more")
          .above(0),
      suture::number("eta", "Pa s", "Viscosity of the damage; explicit steps need one")
          .at_least(0)
          .or_else(0),
      suture::number("r", "1", "Part of the stiffness that a crack leaves")
          .at_least(0)
          .or_else(1e-6)};
  static double density(const suture::values& p) { return p[rho]; }
  static double capacity(const suture::values& p) { return p[viscosity]; }

  static constexpr suture::attribute vertex_fields[] = {
      suture::vertex_field("damage", "1", "0: intact, 1: broken").rising().within(0, 1),
      suture::lumped_capacity<GradientDamage>("damage_capacity", "J s",
                                              "An eighth of eta V of every incident element")};

  template <class T, class P>
  static SUTURE_INLINE T volumetric(const T& change, const P& p) {
    return 0.5 * p[bulk] * (0.5 * change * (change + 2.0) - log1p(change));
  }
  /// I1 - 3 of the part of F that keeps the volume, and J - 1.
  template <class T>
  static SUTURE_INLINE suture::strain_excess<T> strain(const suture::mat3<T>& F) {
    return isochoric(suture::strain_excess<T>{excess_I1(F), T(0.0), excess_J(F)});
  }
  template <class T, class P>
  static SUTURE_INLINE T tension(const suture::mat3<T>& F, const P& p) {
    const auto e = strain(F);
    return 0.5 * p[mu] * e.I1 + volumetric(max(e.J, T(0.0)), p);
  }

  /// 0 beyond 1: neighbours may raise the damage of a node a little above it.
  template <class D>
  static SUTURE_INLINE D what_is_sound(const D& damage) {
    return max(1.0 - damage, D(0.0));
  }

  template <class T, class P, class At>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const P& p, const At& at) {
    const auto sound = what_is_sound(at.field[0]), left = sound * sound + p[residual];
    const auto e = strain(F);
    return left * (0.5 * p[mu] * e.I1) + select(e.J > 0.0, left, 1.0) * volumetric(e.J, p);
  }
  template <class P, class At>
  static auto field_energy(const P& p, const At& at) {
    return 0.375 * p[toughness] *
           (at.field / p[length] + p[length] * dot(at.gradient, at.gradient));
  }
  /// - dW/dd, and - dW/d(grad d) as a flow.
  template <class F, class P, class At>
  static SUTURE_INLINE auto release(const F& f, const P& p, const At& at) {
    const auto driving = 2.0 * what_is_sound(at.field) * tension(f, p);
    return suture::released{driving - 0.375 * p[toughness] / p[length],
                            at.gradient * (-0.75 * p[toughness] * p[length])};
  }
};

SUTURE_PLUGIN("gradient-damage", "0.1.0", "MIT", "Brittle fracture by a phase field",
              GradientDamage)
