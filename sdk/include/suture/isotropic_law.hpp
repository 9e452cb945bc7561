// SPDX-License-Identifier: MIT
//
// suture/isotropic_law.hpp - a law of an isotropic solid whose material is E, nu and rho.
//
//   struct Hooke : suture::isotropic_law<Hooke> {
//     static constexpr const char* id = "hooke"; ...
//     template <class T, class C>
//     static T energy(const suture::mat3<T>& F, const C& c) {
//       const auto e = add_diagonal(symmetric(F), -1.0);
//       return 0.5 * c.lambda * (trace(e) * trace(e)) + c.mu * dot(e, e);
//     }
//   };
#ifndef SUTURE_ISOTROPIC_LAW_HPP
#define SUTURE_ISOTROPIC_LAW_HPP

#include "suture/continuum.hpp"
#include "suture/lame.hpp"

namespace suture {

/// Base of such a model: its parameters, which may differ from element to element, and Lame's
/// constants `lambda` and `mu`, Pa, as the Constants that energy() and stress() receive.
template <class M>
struct isotropic_law : continuum<M> {
  enum { young, poisson, rho };
  static constexpr parameter parameters[] = {
      number("E", "Pa", "Young's modulus at rest").above(0).per_element(),
      number("nu", "1", "Poisson's ratio at rest").above(-1).below(0.5).per_element(),
      number("rho", "kg/m^3", "Density of the rest shape").above(0).per_element()};

  template <class R>
  using Constants = lame_of<R>;
  static void prepare(const setup& p, lame& c) { c = lame_constants(p[young], p[poisson]); }
  template <class P>
  static auto density(const P& p) {
    return p[rho];
  }
};

}  // namespace suture

#endif
