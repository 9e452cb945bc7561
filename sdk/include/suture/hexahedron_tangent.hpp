// SPDX-License-Identifier: MIT
//
// suture/hexahedron_tangent.hpp - directional derivatives of the forces of hexahedron.hpp.
//
// Gradients, fluxes and nodal forces are linear in what they are computed from. Only the law
// is differentiated; everything else is applied to the positions and to the direction, or to
// the derivative alone. Dual numbers throughout would carry the values of stresses and forces,
// which nobody asks for, to the end: half as much again.
#ifndef SUTURE_HEXAHEDRON_TANGENT_HPP
#define SUTURE_HEXAHEDRON_TANGENT_HPP

#include "suture/hexahedron.hpp"

namespace suture {

/// df of internal_force() for the direction dx. law(F, dF, number of the Gauss point) gives dP.
template <int Q, bool Unrolled = (Q == 2), class T, class Geometry, class Law>
SUTURE_INLINE void internal_tangent(const vec3<T> (&x)[8], const vec3<T> (&dx)[8],
                                    const Geometry& geometry, Law&& law, vec3<T> (&df)[8]) {
  axis_values<T, Q> g = Unrolled ? gradients<Q>(x) : called_gradients<Q>(x);
  axis_values<T, Q> dg = Unrolled ? gradients<Q>(dx) : called_gradients<Q>(dx);
  geometry.start(g);
  geometry.start(dg);
  axis_values<T, Q> s{};
  for_each_point<Q, Unrolled>([&](int i, int j, int k) SUTURE_DETAIL_INLINED {
    const auto point = geometry.point(i, j, k);
    const mat3<T> dP =
        law(point.F(g.at(i, j, k)), point.F(dg.at(i, j, k)), point_number<Q>(i, j, k));
    if constexpr (Q == 2)
      point.add_flux(dP, s);
    else
      point.add_flux(dP * point_weight<Q>(i, j, k), s);
  });
  geometry.finish(s);
  if constexpr (Unrolled)
    scatter<Q>(s, df);
  else
    called_scatter<Q>(s, df);
}

/// F'dF + dF'F, twice the derivative of the Green-Lagrange strain.
template <class T>
SUTURE_INLINE sym3<T> twice_green_strain_tangent(const mat3<T>& F, const mat3<T>& dF) {
  const auto &f = F.column, &d = dF.column;
  const auto both = [&](int a, int b)
                        SUTURE_DETAIL_INLINED { return dot(f[a], d[b]) + dot(d[a], f[b]); };
  return {2.0 * dot(f[0], d[0]),
          2.0 * dot(f[1], d[1]),
          2.0 * dot(f[2], d[2]),
          both(0, 1),
          both(1, 2),
          both(0, 2)};
}

/// dP = dF S + F dS of S = lambda tr(E) I + 2 mu E.
template <class T, class R>
SUTURE_INLINE mat3<T> isotropic_tangent(const mat3<T>& F, const mat3<T>& dF, const R& lambda,
                                        const R& mu) {
  const auto stress = [&](const sym3<T>& strain2) SUTURE_DETAIL_INLINED {
    return add_diagonal(mu * strain2, (0.5 * lambda) * trace(strain2));
  };
  const sym3<T> S = stress(twice_green_strain(F)), dS = stress(twice_green_strain_tangent(F, dF));
  return dF * S + F * dS;
}

/// df of isotropic_box_force() for the direction dx: ds = dG M + G dM.
template <int Q, class T, class R, class Box>
SUTURE_INLINE void isotropic_box_tangent(const vec3<T> (&x)[8], const vec3<T> (&dx)[8],
                                         const Box& box, const R& lambda, const R& mu,
                                         vec3<T> (&df)[8]) {
  axis_values<T, Q> g = gradients<Q>(x), dg = gradients<Q>(dx);
  box.shift(g);
  box.shift(dg);
  const isotropic_box<R, Q> constants(box, lambda, mu);
  axis_values<T, Q> s{};
  for_each_point<Q>([&](int i, int j, int k) SUTURE_DETAIL_INLINED {
    const mat3<T> G = g.at(i, j, k), dG = dg.at(i, j, k);
    const double weight = point_weight<Q>(i, j, k);
    s.add_product(i, j, k, dG, constants.flux(G, weight));
    s.add_product(i, j, k, G, constants.flux_tangent(G, dG, weight));
  });
  box.spread(s);
  scatter<Q>(s, df);
}

}  // namespace suture

#endif
