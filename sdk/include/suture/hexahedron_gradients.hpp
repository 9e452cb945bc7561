// SPDX-License-Identifier: MIT
//
// suture/hexahedron_gradients.hpp - local gradients on the trilinear hexahedron.
//
// Local coordinates xi in [0,1]^3; node n sits at (n&1, (n>>1)&1, (n>>2)&1), and
//   x(xi) = sum_n N_n(xi) x_n,   N_n = product over axes of xi or 1 - xi.
//
// x is linear along each local axis, so dx/dxi_d is the difference of the two ends
// of an edge, interpolated between the four edges of direction d. It does not
// depend on xi_d: a rule of Q points per axis has Q^2 different values of it, not
// Q^3, and they are computed axis by axis ("sum factorisation"), without the 8 x 3
// matrix of shape gradients. The transpose of the same steps maps stresses back to
// the nodes. For Q = 2 that is 48 operations per component each way; the shape
// matrix would cost 8 x 24.
#ifndef SUTURE_HEXAHEDRON_GRADIENTS_HPP
#define SUTURE_HEXAHEDRON_GRADIENTS_HPP

#include "suture/tensor.hpp"

namespace suture {

/// Gauss-Legendre on [0,1], Q points, exact for degree 2Q - 1.
/// Points in ascending order and symmetric; `first` is the lowest.
template <int Q>
struct gauss;
template <>
struct gauss<2> {
  static constexpr double first = 0.21132486540518711774542560974902;  // (1 - 1/sqrt 3) / 2
  static constexpr double weight[2] = {0.5, 0.5};
};
template <>
struct gauss<3> {
  static constexpr double first = 0.11270166537925831148207346002176;  // (1 - sqrt 3/5) / 2
  static constexpr double weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
};

/// Weights of the product rule, as a factor common to all points times one per point:
/// for Q = 2 all points have the same weight, which is applied where it costs least.
template <int Q>
inline constexpr double common_weight = Q == 2 ? 0.125 : 1.0;
template <int Q>
SUTURE_INLINE constexpr double point_weight(int i, int j, int k) {
  constexpr const double(&w)[Q] = gauss<Q>::weight;
  return Q == 2 ? 1.0 : w[i] * w[j] * w[k];
}

/// Interpolates from the values `a`, `b` at the ends of an axis to its Gauss points.
template <int Q, class T>
SUTURE_INLINE void to_points(const T& a, const T& b, T* out, int stride) {
  const T step = b - a;
  out[0] = a + gauss<Q>::first * step;
  if constexpr (Q == 3) out[stride] = 0.5 * (a + b);
  out[(Q - 1) * stride] = b - gauss<Q>::first * step;
}

/// The transpose: from values at Gauss points to the ends.
template <int Q, class T>
SUTURE_INLINE void to_ends(const T* in, int stride, T& a, T& b) {
  const T &low = in[0], &high = in[(Q - 1) * stride];
  const T step = gauss<Q>::first * (high - low);
  a = low + step;
  b = high - step;
  if constexpr (Q == 3) {
    const T half = 0.5 * in[stride];
    a += half;
    b += half;
  }
}

/// A vector per local axis d and Gauss point of the two other axes: gradients
/// dx/dxi_d, or the stresses conjugate to them.
template <class T, int Q>
struct axis_values {
  T along[3][3][Q * Q];  // [axis][component][lower other axis + Q * higher other axis]

  /// The three vectors at Gauss point (i, j, k) as columns.
  SUTURE_INLINE mat3<T> at(int i, int j, int k) const {
    const int place[3] = {j + Q * k, i + Q * k, i + Q * j};
    mat3<T> m;
    for (int d = 0; d < 3; ++d)
      for (int c = 0; c < 3; ++c) m(c, d) = along[d][c][place[d]];
    return m;
  }
  SUTURE_INLINE void add(int i, int j, int k, const mat3<T>& m) {
    const int place[3] = {j + Q * k, i + Q * k, i + Q * j};
    for (int d = 0; d < 3; ++d)
      for (int c = 0; c < 3; ++c) along[d][c][place[d]] += m(c, d);
  }
  /// add(i, j, k, A M), each sum a chain of fused operations.
  template <class S>
  SUTURE_INLINE void add_product(int i, int j, int k, const mat3<T>& A, const S& M) {
    const int place[3] = {j + Q * k, i + Q * k, i + Q * j};
    for (int d = 0; d < 3; ++d)
      for (int c = 0; c < 3; ++c) {
        T& sum = along[d][c][place[d]];
        for (int m = 0; m < 3; ++m) sum += A(c, m) * M(m, d);
      }
  }
  template <class S>
  SUTURE_INLINE void scale_axis(int d, const S& s) {
    for (int c = 0; c < 3; ++c)
      for (int p = 0; p < Q * Q; ++p) along[d][c][p] = along[d][c][p] * s;
  }
};

/// dx/dxi at all Gauss points for the field with the values x at the nodes.
template <int Q, class T>
SUTURE_INLINE axis_values<T, Q> gradients(const vec3<T> (&x)[8]) {
  axis_values<T, Q> g;
  for (int d = 0; d < 3; ++d) {
    const auto edge = [&](int m, int c) {
      const auto& e = suture_hexahedron_edges[4 * d + m];
      return x[e[1]][c] - x[e[0]][c];
    };
    for (int c = 0; c < 3; ++c) {
      T line[2][Q];  // [higher end][lower point]
      to_points<Q>(edge(0, c), edge(1, c), line[0], 1);
      to_points<Q>(edge(2, c), edge(3, c), line[1], 1);
      for (int p = 0; p < Q; ++p) to_points<Q>(line[0][p], line[1][p], &g.along[d][c][p], Q);
    }
  }
  return g;
}

/// The same as a function of its own, for loops over the Gauss points, which read the values from
/// memory anyway: the compiler works through it once for all geometries.
template <int Q, class T>
[[gnu::noinline]] axis_values<T, Q> called_gradients(const vec3<T> (&x)[8]) {
  return gradients<Q>(x);
}

/// The transpose of gradients(), negated: f_n = - sum over points and axes of
/// s_d(point) dN_n/dxi_d. With s = P cof(J) w this is the force of stress P.
template <int Q, class T>
SUTURE_INLINE void scatter(const axis_values<T, Q>& s, vec3<T> (&f)[8]) {
  for (int c = 0; c < 3; ++c) {
    T edge[3][4];
    for (int d = 0; d < 3; ++d) {
      T line[2][Q];
      for (int p = 0; p < Q; ++p) to_ends<Q>(&s.along[d][c][p], Q, line[0][p], line[1][p]);
      to_ends<Q>(line[0], 1, edge[d][0], edge[d][1]);
      to_ends<Q>(line[1], 1, edge[d][2], edge[d][3]);
    }
    // Every edge pulls its low end forward and its high end back.
    for (int n = 0; n < 8; ++n) {
      const int i = n & 1, j = (n >> 1) & 1, k = n >> 2;
      const T &x = edge[0][j + 2 * k], &y = edge[1][i + 2 * k], &z = edge[2][i + 2 * j];
      const T yz = j == k ? y + z : j ? z - y : y - z;  // its sign is - if j = k = 1
      f[n][c] = j & k ? (i ? -(x + yz) : x - yz) : (i ? yz - x : yz + x);
    }
  }
}

/// The same as a function of its own.
template <int Q, class T>
[[gnu::noinline]] void called_scatter(const axis_values<T, Q>& s, vec3<T> (&f)[8]) {
  scatter<Q>(s, f);
}

}  // namespace suture

#endif
