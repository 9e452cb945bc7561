// SPDX-License-Identifier: MIT
//
// suture/hexahedron.hpp - integrals over the trilinear hexahedron.
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
#ifndef SUTURE_HEXAHEDRON_HPP
#define SUTURE_HEXAHEDRON_HPP

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

// --------------------------------------------------------------- geometry --
// How local gradients become physical ones, F = dx/dxi J^-1, and how the stress
// P is mapped back, s = P cof(J) = P J^-T det J. A geometry provides
//   start(gradients)      once before the points
//   point(i, j, k)        an object with F(dx/dxi), measure() = det J, and
//                         add_flux(P, stresses), which adds s at that point
//   finish(stresses)      once after the points; afterwards the fluxes include the
//                         factor common_weight<Q>

/// Constant J: parallelepipeds. Holds J^-1 (rows: local axes) and det J.
template <class R, int Q>
struct parallelepiped_geometry {
  mat3<R> inverse_jacobian;
  R volume;
  SUTURE_INLINE explicit parallelepiped_geometry(const mat3<R>& inverse)
      : inverse_jacobian(inverse),
        volume(1.0 / det(inverse)),
        back_(transpose(inverse) * (volume * common_weight<Q>)) {}
  /// `fraction`: of the volume.
  SUTURE_INLINE parallelepiped_geometry(const mat3<R>& inverse, const R& fraction)
      : inverse_jacobian(inverse),
        volume(fraction / det(inverse)),
        back_(transpose(inverse) * (volume * common_weight<Q>)) {}

  struct at_point {
    const parallelepiped_geometry& g;
    int i, j, k;
    template <class T>
    SUTURE_INLINE mat3<T> F(const mat3<T>& gradient) const {
      return gradient * g.inverse_jacobian;
    }
    template <class T>
    SUTURE_INLINE void add_flux(const mat3<T>& P, axis_values<T, Q>& s) const {
      s.add_product(i, j, k, P, g.back_);
    }
    SUTURE_INLINE const R& measure() const { return g.volume; }
  };
  SUTURE_INLINE at_point point(int i, int j, int k) const { return {*this, i, j, k}; }
  template <class T>
  SUTURE_INLINE void start(axis_values<T, Q>&) const {}
  template <class T>
  SUTURE_INLINE void finish(axis_values<T, Q>&) const {}

 private:
  mat3<R> back_;
};

/// Constant diagonal J: boxes along the axes. Scaling the Q^2 values per axis
/// replaces two matrix products at each of the Q^3 points.
template <class R, int Q>
struct box_geometry {
  vec3<R> inverse_length;
  R volume;
  SUTURE_INLINE explicit box_geometry(const mat3<R>& inverse)
      : inverse_length{inverse(0, 0), inverse(1, 1), inverse(2, 2)},
        volume(1.0 / (inverse_length[0] * inverse_length[1] * inverse_length[2])) {}
  /// `fraction`: of the volume.
  SUTURE_INLINE box_geometry(const mat3<R>& inverse, const R& fraction) : box_geometry(inverse) {
    volume = volume * fraction;
  }

  struct at_point {
    const R& volume;
    int i, j, k;
    template <class T>
    SUTURE_INLINE const mat3<T>& F(const mat3<T>& gradient) const {
      return gradient;
    }
    template <class T>
    SUTURE_INLINE void add_flux(const mat3<T>& P, axis_values<T, Q>& s) const {
      s.add(i, j, k, P);
    }
    SUTURE_INLINE const R& measure() const { return volume; }
  };
  SUTURE_INLINE at_point point(int i, int j, int k) const { return {volume, i, j, k}; }
  template <class T>
  SUTURE_INLINE void start(axis_values<T, Q>& gradients) const {
    for (int d = 0; d < 3; ++d) gradients.scale_axis(d, inverse_length[d]);
  }
  template <class T>
  SUTURE_INLINE void finish(axis_values<T, Q>& stresses) const {
    for (int d = 0; d < 3; ++d)
      stresses.scale_axis(d, inverse_length[d] * (volume * common_weight<Q>));
  }
  /// In local coordinates, as those of part_geometry.
  template <class T>
  SUTURE_INLINE void shift(axis_values<T, Q>&) const {}
  template <class T>
  SUTURE_INLINE void spread(axis_values<T, Q>&) const {}
};

/// Any hexahedron: J from the rest positions at every point.
template <class R, int Q>
struct general_geometry {
  axis_values<R, Q> rest;
  SUTURE_INLINE explicit general_geometry(const vec3<R> (&X)[8]) : rest(gradients<Q>(X)) {}

  struct at_point {
    mat3<R> cof;
    R jacobian, inverse;
    int i, j, k;
    SUTURE_INLINE at_point(const mat3<R>& J, int i_, int j_, int k_)
        : cof(cofactor(J)),
          jacobian(dot(J.column[0], cof.column[0])),
          inverse(reciprocal(jacobian)),
          i(i_),
          j(j_),
          k(k_) {}
    template <class T>
    SUTURE_INLINE mat3<T> F(const mat3<T>& gradient) const {
      return gradient * transpose(cof) * inverse;
    }
    template <class T>
    SUTURE_INLINE void add_flux(const mat3<T>& P, axis_values<T, Q>& s) const {
      s.add_product(i, j, k, P, cof);
    }
    SUTURE_INLINE const R& measure() const { return jacobian; }
  };
  SUTURE_INLINE at_point point(int i, int j, int k) const { return {rest.at(i, j, k), i, j, k}; }
  template <class T>
  SUTURE_INLINE void start(axis_values<T, Q>&) const {}
  template <class T>
  SUTURE_INLINE void finish(axis_values<T, Q>& stresses) const {
    if constexpr (Q == 2)
      for (int d = 0; d < 3; ++d) stresses.scale_axis(d, common_weight<Q>);
  }
};

/// Any hexahedron with Q = 2; J^-1 and det J at its points are read from columns of the
/// cell. 4 to 8 columns are fetched while others are in use, so that reading 640 B per
/// element costs less than computing the geometry again (docs/decisions).
/// inverse_column(point, component) and measure_column(point) load the values.
template <class R, class InverseColumn, class MeasureColumn>
struct stored_geometry {
  InverseColumn inverse_column;
  MeasureColumn measure_column;

  struct at_point {
    mat3<R> inverse_jacobian;
    R jacobian;
    int i, j, k;
    template <class T>
    SUTURE_INLINE mat3<T> F(const mat3<T>& gradient) const {
      return gradient * inverse_jacobian;
    }
    template <class T>
    SUTURE_INLINE void add_flux(const mat3<T>& P, axis_values<T, 2>& s) const {
      s.add_product(i, j, k, P * (jacobian * common_weight<2>), transpose(inverse_jacobian));
    }
    SUTURE_INLINE const R& measure() const { return jacobian; }
  };
  SUTURE_INLINE at_point point(int i, int j, int k) const {
    const int number = i + 2 * j + 4 * k;
    at_point p{{}, measure_column(number), i, j, k};
    for (int c = 0; c < 9; ++c) p.inverse_jacobian(c / 3, c % 3) = inverse_column(number, c);
    return p;
  }
  template <class T>
  SUTURE_INLINE void start(axis_values<T, 2>&) const {}
  template <class T>
  SUTURE_INLINE void finish(axis_values<T, 2>&) const {}
};
template <class R, class InverseColumn, class MeasureColumn>
stored_geometry<R, InverseColumn, MeasureColumn> make_stored_geometry(InverseColumn i,
                                                                      MeasureColumn m) {
  return {i, m};
}

// ------------------------------------------------------------------ parts --

/// The part of an element that is material (parts.h): `second` holds the means of yz, xz, xy.
template <class R>
struct part_moments {
  R fraction;
  vec3<R> first, second;
};

/// A parallelepiped of which only a part is material. The usual points keep their places, with the
/// weights times the fraction. To the gradients at all of them it adds the difference between the
/// mean of the part and that of the cube, so that the mean gradient is that of the part: the
/// element passes the patch test, and parts of any size are stable. With the hourglasses
/// h_xy = sum s_x s_y x_n and so on, in coordinates [-1,1]^3, the difference of dx/dx is
///   (first_y h_xy + first_z h_xz + second_yz h_xyz) / 8,
/// and likewise for y and z. The slopes of the gradients between Gauss points contain them.
template <class Geometry, class R, int Q>
struct part_geometry : Geometry {
  SUTURE_INLINE part_geometry(const mat3<R>& inverse, const part_moments<R>& part)
      : Geometry(inverse, part.fraction) {
    constexpr double point = 1 - 2 * gauss<Q>::first;  // the highest, in [-1,1]
    first_ = part.first * R(0.25 / point);
    second_ = part.second * R(0.25 / (point * point));
  }

  template <class T>
  SUTURE_INLINE void start(axis_values<T, Q>& gradients) const {
    shift(gradients);
    Geometry::start(gradients);
  }
  template <class T>
  SUTURE_INLINE void finish(axis_values<T, Q>& stresses) const {
    Geometry::finish(stresses);
    spread(stresses);
  }

  /// Adds the difference to the gradients.
  template <class T>
  SUTURE_INLINE void shift(axis_values<T, Q>& g) const {
    for (int c = 0; c < 3; ++c) {
      const T* const x = g.along[0][c];
      const T* const y = g.along[1][c];
      const T low = x[low_high] - x[low_low], high = x[high_high] - x[high_low];
      const T xy = high + low, xyz = high - low;
      const T xz = (x[high_high] + x[high_low]) - (x[low_high] + x[low_low]);
      const T yz = (y[high_high] + y[high_low]) - (y[low_high] + y[low_low]);
      const T shift[3] = {first_[1] * xy + first_[2] * xz + second_[0] * xyz,
                          first_[0] * xy + first_[2] * yz + second_[1] * xyz,
                          first_[0] * xz + first_[1] * yz + second_[2] * xyz};
      for (int d = 0; d < 3; ++d)
        for (int p = 0; p < Q * Q; ++p) g.along[d][c][p] += shift[d];
    }
  }
  /// The transpose.
  template <class T>
  SUTURE_INLINE void spread(axis_values<T, Q>& s) const {
    for (int c = 0; c < 3; ++c) {
      T sum[3];
      for (int d = 0; d < 3; ++d) {
        sum[d] = s.along[d][c][0];
        for (int p = 1; p < Q * Q; ++p) sum[d] += s.along[d][c][p];
      }
      const T xy = first_[1] * sum[0] + first_[0] * sum[1];
      const T xz = first_[2] * sum[0] + first_[0] * sum[2];
      const T yz = first_[2] * sum[1] + first_[1] * sum[2];
      const T xyz = second_[0] * sum[0] + second_[1] * sum[1] + second_[2] * sum[2];
      T* const x = s.along[0][c];
      T* const y = s.along[1][c];
      x[low_low] += (xyz - xy) - xz;
      x[low_high] += (xy - xyz) - xz;
      x[high_low] += xz - (xy + xyz);
      x[high_high] += xz + (xy + xyz);
      y[low_low] -= yz;
      y[low_high] -= yz;
      y[high_low] += yz;
      y[high_high] += yz;
    }
  }

 private:
  /// Places of the outer Gauss points: first the higher other axis, then the lower.
  enum { low_low = 0, low_high = Q - 1, high_low = Q * (Q - 1), high_high = Q * Q - 1 };
  vec3<R> first_, second_;
};

// -------------------------------------------------------------- integrals --

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

/// Calls visit(F, w det J, number) at every Gauss point, for integrals and averages.
template <int Q, class T, class Geometry, class Visit>
SUTURE_INLINE void for_deformations(const vec3<T> (&x)[8], const Geometry& geometry,
                                    Visit&& visit) {
  axis_values<T, Q> g = gradients<Q>(x);
  geometry.start(g);
  for_each_point<Q, false>([&](int i, int j, int k) SUTURE_DETAIL_INLINED {
    const auto point = geometry.point(i, j, k);
    visit(point.F(g.at(i, j, k)), point.measure() * (common_weight<Q> * point_weight<Q>(i, j, k)),
          point_number<Q>(i, j, k));
  });
}

/// Exact volume: det J has degree 2 in each local coordinate.
template <class T>
SUTURE_INLINE T volume(const vec3<T> (&X)[8]) {
  const axis_values<T, 2> g = gradients<2>(X);
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
