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

}  // namespace suture

#endif
