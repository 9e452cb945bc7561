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

}  // namespace suture

#endif
