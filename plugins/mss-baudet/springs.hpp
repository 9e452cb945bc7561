// SPDX-License-Identifier: MIT
//
// One spring between two nodes, and the correction of one element, for any
// scalar type (double, packs, duals).
#ifndef MSS_BAUDET_SPRINGS_HPP
#define MSS_BAUDET_SPRINGS_HPP

#include "box.hpp"

namespace mss_baudet {

/// Squares of lengths outside this range (m^2) are invalid: zero, where a force has
/// no direction, not a number, or infinite.
template <class T>
SUTURE_INLINE auto is_length_squared(const T& x) {
  return (x > T(1e-200)) & (x < T(1e200));
}

/// Elastic force on the first node, along d = x_1 - x_0, divided by |d| (N/m):
/// of all springs k_e, l_e that lie on one another at once, as both sums add up
/// when elements meet and part when a cut parts them:
///   sum_e k_e (|d| - l_e) / |d| = K - L / |d|,   K = sum_e k_e,  L = sum_e k_e l_e
template <class T, class R>
SUTURE_INLINE T elastic(const T& inverse_length, const R& K, const R& L) {
  return K - L * inverse_length;
}

/// 1/2 K (|d| - L/K)^2: the common rest length is L/K.
template <class T, class R>
SUTURE_INLINE T spring_energy(const T& length, const R& K, const R& rest_length) {
  const T stretch = length - rest_length;
  return 0.5 * K * stretch * stretch;
}

/// Viscosity of a spring, N s/m: `factor` 2 sqrt(k (m_0 + m_1) / 2), from the
/// accumulated stiffness and masses: it is not additive, so it is never stored.
template <class F, class R>
SUTURE_INLINE R viscosity(const F& factor, const R& K, const R& mass) {
  using suture::max;
  const R square = max(2.0 * K * mass, R(0.0));
  return factor * square * rsqrt(max(square, R(1e-200)));
}

/// Viscous force on the first node, along d, divided by |d| (N/m):
///   gamma ((v_1 - v_0) . u) u,  u = d / |d|
template <class T, class R>
SUTURE_INLINE T viscous(const vec3<T>& d, const vec3<T>& relative_velocity, const T& inverse_length,
                        const R& gamma) {
  return gamma * dot(relative_velocity, d) * (inverse_length * inverse_length);
}

/// a u u' + b (I - u u') as a symmetric matrix.
template <class T>
SUTURE_INLINE suture::sym3<T> axial_and_transversal(const vec3<T>& u, const T& a, const T& b) {
  const T c = a - b;
  return {c * u[0] * u[0] + b, c * u[1] * u[1] + b, c * u[2] * u[2] + b,
          c * u[0] * u[1],     c * u[1] * u[2],     c * u[0] * u[2]};
}

/// Bound of a spring's stiffness at either end. The spring has
///   x' K x = (x_1 - x_0)' M (x_1 - x_0),  M = K u u' + (K - L/|d|) (I - u u')
/// and (p - q)' M (p - q) <= 2 p'Mp + 2 q'Mq for M >= 0; what is negative in M
/// (compression) only helps and is left out.
template <class T>
SUTURE_INLINE suture::sym3<T> stiffness_bound(const vec3<T>& u, const T& K,
                                              const T& force_per_length) {
  using suture::max;
  return axial_and_transversal(u, 2.0 * max(K, T(0.0)), 2.0 * max(force_per_length, T(0.0)));
}

/// Bound of a spring's damping gamma u u' at either end, likewise. (Splitting by
/// the masses is exact for one spring, and 5 % worse for a block: it burdens nodes
/// with light neighbours.)
template <class T>
SUTURE_INLINE suture::sym3<T> damping_bound(const vec3<T>& u, const T& gamma) {
  return axial_and_transversal(u, 2.0 * gamma, 0.0 * gamma);
}

/// Mean edge vectors of a deformed element and what the correction makes of them.
template <class T>
struct CorrectedBox {
  vec3<T> axis[3];      ///< A_a = sum_n side_a(n) x_n / 4, m
  T inverse_length[3];  ///< 1/|A_a|
  T elongation[3];      ///< |A_a| - l_a, m
  T tension[3];         ///< sum_b B_ab (|A_b| - l_b), N

  template <class Node, class R>
  SUTURE_INLINE CorrectedBox(const Node& node, const suture::sym3<R>& B, const vec3<R>& rest) {
    for (int a = 0; a < 3; ++a) {
      axis[a] = mean_edge(node, a);
      const T square = dot(axis[a], axis[a]);
      inverse_length[a] = rsqrt(square);
      elongation[a] = square * inverse_length[a] - rest[a];
    }
    for (int a = 0; a < 3; ++a)
      tension[a] = elongation[0] * B(a, 0) + elongation[1] * B(a, 1) + elongation[2] * B(a, 2);
  }

  /// F_n = -dU/dx_n = - sum_a side_a(n) tension_a A_a / |A_a|
  SUTURE_INLINE void add_forces(vec3<T> (&force)[8]) const {
    vec3<T> g[3];
    for (int a = 0; a < 3; ++a) g[a] = axis[a] * (tension[a] * inverse_length[a]);
    for (int n = 0; n < 8; ++n)
      for (int a = 0; a < 3; ++a) force[n] = side(n, a) > 0 ? force[n] - g[a] : force[n] + g[a];
  }

  /// U = 2 sum_ab B_ab delta_a delta_b
  SUTURE_INLINE T energy() const {
    return 2.0 *
           (tension[0] * elongation[0] + tension[1] * elongation[1] + tension[2] * elongation[2]);
  }
};

/// Bound of the correction's stiffness, the same at each of the 8 nodes. With
/// p_a = A_a-component of the variation along u_a, Gershgorin bounds the first
/// term of d2U = 4 sum_ab B_ab p_a p_b + sum_a 4 tension_a/|A_a| |p_a transversal|^2
/// by c_a = B_aa + sum_{b != a} |B_ab|, and |sum_n side(n) y_n / 4|^2 <= sum_n y_n^2 / 2.
template <class T, class R>
SUTURE_INLINE suture::sym3<T> stiffness_bound(const CorrectedBox<T>& box,
                                              const suture::sym3<R>& B) {
  using suture::abs;
  using suture::max;
  suture::sym3<T> sum{};
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    const T axial = max(B(a, a) + abs(B(a, b)) + abs(B(a, c)), R(0.0));
    const T transversal = max(box.tension[a] * box.inverse_length[a], T(0.0));
    sum = sum + axial_and_transversal(box.axis[a] * box.inverse_length[a], T(2.0 * axial),
                                      T(2.0 * transversal));
  }
  return sum;
}

}  // namespace mss_baudet

#endif
