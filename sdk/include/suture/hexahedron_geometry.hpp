// SPDX-License-Identifier: MIT
//
// suture/hexahedron_geometry.hpp - the Jacobians of hexahedra at rest.
//
// How local gradients become physical ones, F = dx/dxi J^-1, and how the stress
// P is mapped back, s = P cof(J) = P J^-T det J. A geometry provides
//   start(gradients)      once before the points
//   point(i, j, k)        an object with F(dx/dxi), measure() = det J, and
//                         add_flux(P, stresses), which adds s at that point
//   finish(stresses)      once after the points; afterwards the fluxes include the
//                         factor common_weight<Q>
#ifndef SUTURE_HEXAHEDRON_GEOMETRY_HPP
#define SUTURE_HEXAHEDRON_GEOMETRY_HPP

#include "suture/hexahedron_gradients.hpp"

namespace suture {

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

/// The part of a general hexahedron (parts.h): `more` holds d_1 ... d_4.
template <class R>
struct general_part {
  R fraction;
  vec3<R> more[4];
};

/// The hourglasses of one component of a field, as slopes of its gradients in [0,1]^3 between the
/// outer Gauss points. They are 8 p times the coefficients of yz, zx and xy in [-1,1]^3, and 8 p^2
/// times that of xyz, where p is the place of the highest point.
template <class T, int Q>
struct gradient_slopes {
  T yz, zx, xy, xyz;

  static constexpr double p = 1 - 2 * gauss<Q>::first;
  /// Places of the outer Gauss points: first the higher other axis, then the lower.
  enum { low_low = 0, low_high = Q - 1, high_low = Q * (Q - 1), high_high = Q * Q - 1 };

  SUTURE_INLINE gradient_slopes() = default;
  SUTURE_INLINE gradient_slopes(const axis_values<T, Q>& g, int component) {
    const T* const x = g.along[0][component];
    const T* const y = g.along[1][component];
    const T low = x[low_high] - x[low_low], high = x[high_high] - x[high_low];
    xy = high + low;
    xyz = high - low;
    zx = (x[high_high] + x[high_low]) - (x[low_high] + x[low_low]);
    yz = (y[high_high] + y[high_low]) - (y[low_high] + y[low_low]);
  }
  /// The transpose.
  SUTURE_INLINE void add_to(axis_values<T, Q>& s, int component) const {
    T* const x = s.along[0][component];
    T* const y = s.along[1][component];
    x[low_low] += (xyz - xy) - zx;
    x[low_high] += (xy - xyz) - zx;
    x[high_low] += zx - (xy + xyz);
    x[high_high] += zx + (xy + xyz);
    y[low_low] -= yz;
    y[low_high] -= yz;
    y[high_low] += yz;
    y[high_high] += yz;
  }
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
    constexpr double p = gradient_slopes<R, Q>::p;
    first_ = part.first * R(0.25 / p);
    second_ = part.second * R(0.25 / (p * p));
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
      const gradient_slopes<T, Q> h(g, c);
      const T shift[3] = {first_[1] * h.xy + first_[2] * h.zx + second_[0] * h.xyz,
                          first_[0] * h.xy + first_[2] * h.yz + second_[1] * h.xyz,
                          first_[0] * h.zx + first_[1] * h.yz + second_[2] * h.xyz};
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
      gradient_slopes<T, Q> h;
      h.xy = first_[1] * sum[0] + first_[0] * sum[1];
      h.zx = first_[2] * sum[0] + first_[0] * sum[2];
      h.yz = first_[2] * sum[1] + first_[1] * sum[2];
      h.xyz = second_[0] * sum[0] + second_[1] * sum[1] + second_[2] * sum[2];
      h.add_to(s, c);
    }
  }

 private:
  vec3<R> first_, second_;
};

/// Any hexahedron of which only a part is material, by the same rule: with the coefficients A of
/// the edges and H_k of the hourglasses of a field in [-1,1]^3, what is added to its gradients is
///   D = sum_k (H_k - A c_k) (x) E^-T d_k,   E and c_k = E^-1 H_k of the rest positions (parts.h).
/// In local coordinates that is D J, which varies from point to point as J does.
template <class R, int Q>
struct general_part_geometry : general_geometry<R, Q> {
  using whole = general_geometry<R, Q>;
  SUTURE_INLINE general_part_geometry(const vec3<R> (&X)[8], const general_part<R>& part)
      : whole(X), fraction_(part.fraction) {
    mat3<R> E;
    vec3<R> H[4];
    for (int c = 0; c < 3; ++c) {
      const modes<R> at_rest(this->rest, c);
      for (int i = 0; i < 3; ++i) E(c, i) = at_rest.of[i];
      for (int k = 0; k < 4; ++k) H[k][c] = at_rest.of[3 + k];
    }
    const mat3<R> inverse_e = inverse(E);
    for (int i = 0; i < 3; ++i) rows_[i] = {R(0.0), R(0.0), R(0.0)};
    for (int k = 0; k < 4; ++k) {
      const vec3<R> c = inverse_e * H[k];
      rows_[3 + k] = transpose(inverse_e) * part.more[k];
      for (int i = 0; i < 3; ++i) rows_[i] -= rows_[3 + k] * c[i];
    }
  }

  struct at_point : whole::at_point {
    R fraction;
    SUTURE_INLINE R measure() const { return fraction * this->jacobian; }
  };
  SUTURE_INLINE at_point point(int i, int j, int k) const {
    return {whole::point(i, j, k), fraction_};
  }
  template <class T>
  SUTURE_INLINE void start(axis_values<T, Q>& g) const {
    for (int c = 0; c < 3; ++c) {
      const modes<T> now(g, c);
      T D[3] = {T(0.0), T(0.0), T(0.0)};
      for (int i = 0; i < 7; ++i)
        for (int m = 0; m < 3; ++m) D[m] += rows_[i][m] * now.of[i];
      for (int d = 0; d < 3; ++d)
        for (int m = 0; m < 3; ++m)
          for (int p = 0; p < Q * Q; ++p) g.along[d][c][p] += D[m] * this->rest.along[d][m][p];
    }
  }
  template <class T>
  SUTURE_INLINE void finish(axis_values<T, Q>& s) const {
    for (int d = 0; d < 3; ++d) s.scale_axis(d, fraction_ * common_weight<Q>);
    for (int c = 0; c < 3; ++c) {
      T D[3] = {T(0.0), T(0.0), T(0.0)};
      for (int d = 0; d < 3; ++d)
        for (int m = 0; m < 3; ++m)
          for (int p = 0; p < Q * Q; ++p) D[m] += s.along[d][c][p] * this->rest.along[d][m][p];
      modes<T> pull;
      for (int i = 0; i < 7; ++i)
        pull.of[i] = rows_[i][0] * D[0] + rows_[i][1] * D[1] + rows_[i][2] * D[2];
      pull.add_to(s, c);
    }
  }

 private:
  /// The coefficients of one component of a field: x, y, z, yz, zx, xy, xyz.
  template <class T>
  struct modes {
    using slopes = gradient_slopes<T, Q>;
    static constexpr double edge = 1.0 / 8, slope = 1 / (8 * slopes::p), twist = slope / slopes::p;
    static constexpr int corners[4] = {slopes::low_low, slopes::low_high, slopes::high_low,
                                       slopes::high_high};
    T of[7];

    SUTURE_INLINE modes() = default;
    SUTURE_INLINE modes(const axis_values<T, Q>& g, int c) {
      for (int d = 0; d < 3; ++d) {
        of[d] = T(0.0);
        for (const int p : corners) of[d] += edge * g.along[d][c][p];
      }
      const slopes h(g, c);
      of[3] = slope * h.yz;
      of[4] = slope * h.zx;
      of[5] = slope * h.xy;
      of[6] = twist * h.xyz;
    }
    /// The transpose.
    SUTURE_INLINE void add_to(axis_values<T, Q>& s, int c) const {
      for (int d = 0; d < 3; ++d)
        for (const int p : corners) s.along[d][c][p] += edge * of[d];
      slopes h;
      h.yz = slope * of[3];
      h.zx = slope * of[4];
      h.xy = slope * of[5];
      h.xyz = twist * of[6];
      h.add_to(s, c);
    }
  };

  vec3<R> rows_[7];  ///< by which D consists of the modes of each component
  R fraction_;
};

}  // namespace suture

#endif
