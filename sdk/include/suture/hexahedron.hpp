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

/// S = lambda tr(E) I + 2 mu E (second Piola-Kirchhoff stress, Pa) on boxes along the axes.
/// With the lengths l_a, G = dx/dxi and D_a = 1/l_a, F = G D, so
///   2 E_ab = D_a D_b (G'G)_ab - delta_ab,   s = P cof(J) = G M,
///   M_ab = V D_a D_b S_ab:   M_ab = mu V D_a^2 D_b^2 (G'G)_ab           (a != b)
///                            M_aa = V D_a^2 (lambda tr(E) + mu 2 E_aa)
/// The lengths enter six numbers of M instead of nine of F and nine of P: a tenth fewer
/// operations than internal_force() with box_geometry.
template <class R, int Q>
struct isotropic_box {
  vec3<R> square;             ///< D_a^2
  vec3<R> weight, mu_weight;  ///< V D_a^2, mu V D_a^2, with the common weight of the points
  R xy, yz, xz, half_lambda;

  SUTURE_INLINE isotropic_box(const box_geometry<R, Q>& box, const R& lambda, const R& mu)
      : half_lambda(0.5 * lambda) {
    const vec3<R>& D = box.inverse_length;
    square = {D[0] * D[0], D[1] * D[1], D[2] * D[2]};
    weight = square * (box.volume * common_weight<Q>);
    mu_weight = weight * mu;
    xy = mu_weight[0] * square[1];
    yz = mu_weight[1] * square[2];
    xz = mu_weight[0] * square[2];
  }

  /// M for G, times the weight of the point.
  template <class T>
  SUTURE_INLINE sym3<T> flux(const mat3<T>& G, double point) const {
    const auto& c = G.column;
    vec3<T> strain2;
    for (int a = 0; a < 3; ++a) strain2[a] = square[a] * dot(c[a], c[a]) - 1.0;
    return sum(strain2, dot(c[0], c[1]), dot(c[1], c[2]), dot(c[0], c[2]), point);
  }
  /// dM for G and dG, likewise.
  template <class T>
  SUTURE_INLINE sym3<T> flux_tangent(const mat3<T>& G, const mat3<T>& dG, double point) const {
    const auto &c = G.column, &d = dG.column;
    vec3<T> strain2;
    for (int a = 0; a < 3; ++a) strain2[a] = (2.0 * square[a]) * dot(c[a], d[a]);
    const auto both = [&](int a, int b)
                          SUTURE_DETAIL_INLINED { return dot(c[a], d[b]) + dot(d[a], c[b]); };
    return sum(strain2, both(0, 1), both(1, 2), both(0, 2), point);
  }

 private:
  template <class T>
  SUTURE_INLINE sym3<T> sum(const vec3<T>& strain2, const T& G_xy, const T& G_yz, const T& G_xz,
                            double point) const {
    const T pressure = half_lambda * (strain2[0] + strain2[1] + strain2[2]);
    vec3<T> diagonal;
    for (int a = 0; a < 3; ++a) diagonal[a] = mu_weight[a] * strain2[a] + weight[a] * pressure;
    const sym3<T> M{diagonal[0], diagonal[1], diagonal[2], xy * G_xy, yz * G_yz, xz * G_xz};
    if constexpr (Q == 2)
      return M;
    else
      return M * point;
  }
};

/// Nodal forces of that law; `box` may be a part of one.
template <int Q, class T, class R, class Box>
SUTURE_INLINE void isotropic_box_force(const vec3<T> (&x)[8], const Box& box, const R& lambda,
                                       const R& mu, vec3<T> (&f)[8]) {
  axis_values<T, Q> g = gradients<Q>(x);
  box.shift(g);
  const isotropic_box<R, Q> constants(box, lambda, mu);
  axis_values<T, Q> s{};
  for_each_point<Q>([&](int i, int j, int k) SUTURE_DETAIL_INLINED {
    const mat3<T> G = g.at(i, j, k);
    s.add_product(i, j, k, G, constants.flux(G, point_weight<Q>(i, j, k)));
  });
  box.spread(s);
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
