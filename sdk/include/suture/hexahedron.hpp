// SPDX-License-Identifier: MIT
//
// suture/hexahedron.hpp - integrals over the trilinear hexahedron, from the local gradients of
// hexahedron_gradients.hpp and a geometry of hexahedron_geometry.hpp.
#ifndef SUTURE_HEXAHEDRON_HPP
#define SUTURE_HEXAHEDRON_HPP

#include "suture/hexahedron_geometry.hpp"

namespace suture {

/// Calls visit(i, j, k) at every Gauss point. Unrolled, if that keeps the intermediate values of
/// neighbouring points in registers.
template <int Q, bool Unrolled = (Q == 2), class Visit>
SUTURE_INLINE void for_each_point(Visit&& visit) {
  if constexpr (Unrolled) {
    static_assert(Q == 2);
    visit(0, 0, 0), visit(1, 0, 0), visit(0, 1, 0), visit(1, 1, 0);
    visit(0, 0, 1), visit(1, 0, 1), visit(0, 1, 1), visit(1, 1, 1);
  } else {
    SUTURE_DETAIL_ROLLED
    for (int point = 0; point < Q * Q * Q; ++point)
      visit(point % Q, point / Q % Q, point / (Q * Q));
  }
}

/// The number of a Gauss point, x fastest.
template <int Q>
constexpr int point_number(int i, int j, int k) {
  return i + Q * (j + Q * k);
}

/// Nodal forces of a law(F, number of the Gauss point) that gives P (first Piola-Kirchhoff
/// stress, Pa):
///   f_n = - integral of P grad N_n dX.
template <int Q, bool Unrolled = (Q == 2), class T, class Geometry, class Law>
SUTURE_INLINE void internal_force(const vec3<T> (&x)[8], const Geometry& geometry, Law&& law,
                                  vec3<T> (&f)[8]) {
  axis_values<T, Q> g = gradients<Q>(x);
  geometry.start(g);
  axis_values<T, Q> s{};
  for_each_point<Q, Unrolled>([&](int i, int j, int k) SUTURE_DETAIL_INLINED {
    const auto point = geometry.point(i, j, k);
    const mat3<T> P = law(point.F(g.at(i, j, k)), point_number<Q>(i, j, k));
    if constexpr (Q == 2)
      point.add_flux(P, s);
    else
      point.add_flux(P * point_weight<Q>(i, j, k), s);
  });
  geometry.finish(s);
  scatter<Q>(s, f);
}

/// Calls visit(F, w det J) at every Gauss point, for integrals and averages.
template <int Q, class T, class Geometry, class Visit>
SUTURE_INLINE void for_deformations(const vec3<T> (&x)[8], const Geometry& geometry,
                                    Visit&& visit) {
  axis_values<T, Q> g = called_gradients<Q>(x);
  geometry.start(g);
  for_each_point<Q, false>([&](int i, int j, int k) SUTURE_DETAIL_INLINED {
    const auto point = geometry.point(i, j, k);
    visit(point.F(g.at(i, j, k)), point.measure() * (common_weight<Q> * point_weight<Q>(i, j, k)));
  });
}

/// Exact volume: det J has degree 2 in each local coordinate.
template <class T>
SUTURE_INLINE T volume(const vec3<T> (&X)[8]) {
  const axis_values<T, 2> g = called_gradients<2>(X);
  T sum(0.0);
  for (int p = 0; p < 8; ++p) sum += det(g.at(p & 1, (p >> 1) & 1, p >> 2));
  return sum * 0.125;
}

/// Mean edge vectors of the three local axes as columns: J of a parallelepiped,
/// and dx/dxi at the centre of any hexahedron.
template <class T>
SUTURE_INLINE mat3<T> mean_edges(const vec3<T> (&x)[8]) {
  mat3<T> m;
  for (int d = 0; d < 3; ++d) {
    const auto* e = &suture_hexahedron_edges[4 * d];
    m.column[d] = 0.25 * ((x[e[0][1]] - x[e[0][0]]) + (x[e[1][1]] - x[e[1][0]]) +
                          (x[e[2][1]] - x[e[2][0]]) + (x[e[3][1]] - x[e[3][0]]));
  }
  return m;
}

}  // namespace suture

#endif
