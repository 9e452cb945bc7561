// SPDX-License-Identifier: MIT
//
// suture/mass.hpp - the mass of models on hexahedra.
//
//   template <class P> static auto density(const P& p) { return p[rho]; }  // kg/m^3
//   static constexpr suture::attribute attributes[] = {suture::lumped_mass<MyModel>(), ...};
#ifndef SUTURE_MASS_HPP
#define SUTURE_MASS_HPP

#include "suture/hexahedron.hpp"
#include "suture/model.hpp"

namespace suture {

namespace detail {
template <class M>
struct lumped_share {
  static constexpr int components = 1;
  template <class Cell, class Out>
  static void compute(const Cell& c, const Out& out) {
    vec3<typename Cell::real> X[8];
    for (int n = 0; n < 8; ++n) X[n] = c.rest(n);
    const auto share = volume(X) * (0.125 * M::density(c.parameters()));
    for (int n = 0; n < 8; ++n) out.set(n, 0, share);
  }
};
}  // namespace detail

/// An attribute: M::density(p) times an eighth of the exact volume of every incident element.
template <class M>
constexpr attribute lumped_mass() {
  return vertex_attribute("mass", "kg", "An eighth of the mass of every incident element")
      .from_volumes(contribution<M, detail::lumped_share<M>>)
      .flag(SUTURE_SHARED_MASS);
}

}  // namespace suture

#endif
