// SPDX-License-Identifier: MIT
//
// suture/saint_venant_kirchhoff.hpp - the solid of St Venant and Kirchhoff, whose second
// Piola-Kirchhoff stress (Pa) is linear in Green's strain:
//   E = (F'F - I)/2,  W = lambda/2 (tr E)^2 + mu tr(E^2),  S = lambda tr(E) I + 2 mu E,  P = F S
// with a path of its own on boxes. A law of continuum.hpp asks for all of it by
// saint_venant_kirchhoff(p). Source: Holzapfel, Nonlinear Solid Mechanics, 2000, eq. 6.151.
#ifndef SUTURE_SAINT_VENANT_KIRCHHOFF_HPP
#define SUTURE_SAINT_VENANT_KIRCHHOFF_HPP

#include "suture/hexahedron_tangent.hpp"
#include "suture/lame.hpp"

namespace suture {

/// W, J/m^3.
template <class T, class R>
SUTURE_INLINE T saint_venant_kirchhoff_energy(const mat3<T>& F, const lame_of<R>& c) {
  const sym3<T> E = green_strain(F);
  return 0.5 * c.lambda * trace(E) * trace(E) + c.mu * dot(E, E);
}

/// P = F S, Pa.
template <class T, class R>
SUTURE_INLINE mat3<T> saint_venant_kirchhoff_stress(const mat3<T>& F, const lame_of<R>& c) {
  const sym3<T> strain2 = twice_green_strain(F);  // 2 E
  return F * add_diagonal(c.mu * strain2, (0.5 * c.lambda) * trace(strain2));
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
SUTURE_INLINE mat3<T> saint_venant_kirchhoff_tangent(const mat3<T>& F, const mat3<T>& dF,
                                                     const R& lambda, const R& mu) {
  const auto stress = [&](const sym3<T>& strain2) SUTURE_DETAIL_INLINED {
    return add_diagonal(mu * strain2, (0.5 * lambda) * trace(strain2));
  };
  const sym3<T> S = stress(twice_green_strain(F)), dS = stress(twice_green_strain_tangent(F, dF));
  return dF * S + F * dS;
}

/// S on boxes along the axes.
/// With the lengths l_a, G = dx/dxi and D_a = 1/l_a, F = G D, so
///   2 E_ab = D_a D_b (G'G)_ab - delta_ab,   s = P cof(J) = G M,
///   M_ab = V D_a D_b S_ab:   M_ab = mu V D_a^2 D_b^2 (G'G)_ab           (a != b)
///                            M_aa = V D_a^2 (lambda tr(E) + mu 2 E_aa)
/// The lengths enter six numbers of M instead of nine of F and nine of P: a tenth fewer
/// operations than internal_force() with box_geometry.
template <class R, int Q>
struct saint_venant_kirchhoff_box {
  vec3<R> square;             ///< D_a^2
  vec3<R> weight, mu_weight;  ///< V D_a^2, mu V D_a^2, with the common weight of the points
  R xy, yz, xz, half_lambda;

  SUTURE_INLINE saint_venant_kirchhoff_box(const box_geometry<R, Q>& box, const R& lambda,
                                           const R& mu)
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

/// Nodal forces, N; `box` may be a part of one.
template <int Q, class T, class R, class Box>
SUTURE_INLINE void saint_venant_kirchhoff_box_force(const vec3<T> (&x)[8], const Box& box,
                                                    const R& lambda, const R& mu, vec3<T> (&f)[8]) {
  axis_values<T, Q> g = gradients<Q>(x);
  box.shift(g);
  const saint_venant_kirchhoff_box<R, Q> constants(box, lambda, mu);
  axis_values<T, Q> s{};
  for_each_point<Q>([&](int i, int j, int k) SUTURE_DETAIL_INLINED {
    const mat3<T> G = g.at(i, j, k);
    s.add_product(i, j, k, G, constants.flux(G, point_weight<Q>(i, j, k)));
  });
  box.spread(s);
  scatter<Q>(s, f);
}

/// df of saint_venant_kirchhoff_box_force() for the direction dx: ds = dG M + G dM.
template <int Q, class T, class R, class Box>
SUTURE_INLINE void saint_venant_kirchhoff_box_tangent(const vec3<T> (&x)[8], const vec3<T> (&dx)[8],
                                                      const Box& box, const R& lambda, const R& mu,
                                                      vec3<T> (&df)[8]) {
  axis_values<T, Q> g = gradients<Q>(x), dg = gradients<Q>(dx);
  box.shift(g);
  box.shift(dg);
  const saint_venant_kirchhoff_box<R, Q> constants(box, lambda, mu);
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
