// SPDX-License-Identifier: MIT
//
// suture/kinematics.hpp - what laws are written with besides F itself: invariants, the isochoric
// part of a deformation, rotations, and functions of symmetric matrices. For numbers, packs and
// duals; invariants(), those less their values at rest and isochoric() also for the variables of
// reverse.hpp.
#ifndef SUTURE_KINEMATICS_HPP
#define SUTURE_KINEMATICS_HPP

#include "suture/reverse.hpp"

namespace suture {

/// I1 = tr C, I2 = ((tr C)^2 - tr C^2) / 2 and J = det F of F, C = F'F.
template <class T>
struct strain_invariants {
  T I1, I2, J;
};
/// I2 is the sum of the squares of the cofactors.
template <class T>
SUTURE_INLINE strain_invariants<T> invariants(const mat3<T>& F) {
  const mat3<T> cof = cofactor(F);
  return {dot(F, F), dot(cof, cof), dot(F.column[0], cof.column[0])};
}

/// The invariants of J^(-1/3) F: I1 J^(-2/3) and I2 J^(-4/3), beside J.
template <class T>
SUTURE_INLINE strain_invariants<T> isochoric(const strain_invariants<T>& a) {
  const T scale = reciprocal(cbrt(a.J * a.J));
  return {a.I1 * scale, a.I2 * (scale * scale), a.J};
}
// I1 - 3, I2 - 3 and J - 1, with all digits near F = I. A law that is written with them and with
// log1p() and expm1() vanishes at rest; written with the invariants it is a difference of large
// numbers there, and its rounding is far above the energy of small strains.

namespace detail {

/// The sum of the squares of A, less 3, for the diagonal d + 1 of A.
template <class T>
SUTURE_INLINE T squares_less_3(const mat3<T>& A, const vec3<T>& d) {
  return (d[0] * (d[0] + 2.0) + d[1] * (d[1] + 2.0) + d[2] * (d[2] + 2.0)) +
         (A(0, 1) * A(0, 1) + A(1, 0) * A(1, 0) + A(1, 2) * A(1, 2)) +
         (A(2, 1) * A(2, 1) + A(2, 0) * A(2, 0) + A(0, 2) * A(0, 2));
}
/// The diagonal of F - I.
template <class T>
SUTURE_INLINE vec3<T> diagonal_less_1(const mat3<T>& F) {
  return {F(0, 0) - 1.0, F(1, 1) - 1.0, F(2, 2) - 1.0};
}
/// The diagonal of cof F - I at place i, from that of F - I; j and k follow i.
template <class T>
SUTURE_INLINE T cofactor_less_1(const mat3<T>& F, const vec3<T>& h, int j, int k) {
  return h[j] + h[k] + (h[j] * h[k] - F(j, k) * F(k, j));
}

}  // namespace detail

/// I1 - 3
template <class T>
SUTURE_INLINE T excess_I1(const mat3<T>& F) {
  return detail::squares_less_3(F, detail::diagonal_less_1(F));
}
/// J - 1
template <class T>
SUTURE_INLINE T excess_J(const mat3<T>& F) {
  const vec3<T> h = detail::diagonal_less_1(F);
  const T k = detail::cofactor_less_1(F, h, 1, 2);
  return h[0] + k +
         (h[0] * k + F(1, 0) * (F(0, 2) * F(2, 1) - F(0, 1) * F(2, 2)) +
          F(2, 0) * (F(0, 1) * F(1, 2) - F(0, 2) * F(1, 1)));
}
template <class T>
struct strain_excess {
  T I1, I2, J;
};
/// All three: for laws with I2, as it costs three times as much as the others.
template <class T>
SUTURE_INLINE strain_excess<T> excess_invariants(const mat3<T>& F) {
  const vec3<T> h = detail::diagonal_less_1(F);
  const vec3<T> k{detail::cofactor_less_1(F, h, 1, 2), detail::cofactor_less_1(F, h, 2, 0),
                  detail::cofactor_less_1(F, h, 0, 1)};
  const mat3<T> cof = cofactor(F);
  return {detail::squares_less_3(F, h), detail::squares_less_3(cof, k),
          h[0] + k[0] + (h[0] * k[0] + F(1, 0) * cof(1, 0) + F(2, 0) * cof(2, 0))};
}

/// The same of J^(-1/3) F, beside J - 1.
template <class T>
SUTURE_INLINE strain_excess<T> isochoric(const strain_excess<T>& e) {
  const T J = e.J + 1.0, c = cbrt(J * J), scale = reciprocal(c);
  // scale - 1 = (1 - c) / c, and J^2 - 1 = c^3 - 1
  const T change = e.J * (e.J + 2.0) * scale * reciprocal(-1.0 - c - c * c);
  return {e.I1 * scale + 3.0 * change, e.I2 * (scale * scale) + 3.0 * (change * (scale + 1.0)),
          e.J};
}
/// J^(-1/3) F, the part of F that keeps the volume.
template <class T>
SUTURE_INLINE mat3<T> isochoric(const mat3<T>& F) {
  return F * reciprocal(cbrt(det(F)));
}

/// dI1/dF = 2 F
template <class T>
SUTURE_INLINE mat3<T> gradient_of_I1(const mat3<T>& F) {
  return F * 2.0;
}
/// dI2/dF = 2 (I1 F - F C)
template <class T>
SUTURE_INLINE mat3<T> gradient_of_I2(const mat3<T>& F) {
  return (F * dot(F, F) - F * right_cauchy_green(F)) * 2.0;
}
/// dJ/dF
template <class T>
SUTURE_INLINE mat3<T> gradient_of_J(const mat3<T>& F) {
  return cofactor(F);
}

// --------------------------------------------------------------- rotation --

/// R of the polar decomposition F = R U, det F > 0: Newton's iteration X -> (X + X^-T) / 2 (Higham,
/// SIAM J. Sci. Stat. Comput. 7, 1986, 1160-1174). It squares the distance from a rotation, and
/// halves stretches that are large or small: 4 steps for strains of 10 %, 10 for stretches of 50 or
/// 1/50. Each cell of a pack ends with its own last step, so that none depends on its neighbours.
template <class T>
SUTURE_INLINE mat3<T> polar_rotation(const mat3<T>& F) {
  mat3<T> X = F;
  auto moves = dot(F, F) > 0.0;
  for (int step = 0; step < 30 && any(moves); ++step) {
    const mat3<T> cof = cofactor(X);
    const T half = 0.5 * reciprocal(dot(X.column[0], cof.column[0]));
    const mat3<T> next = X * 0.5 + cof * half, change = next - X;
    for (int i = 0; i < 9; ++i)
      X(i / 3, i % 3) = select(moves, next(i / 3, i % 3), X(i / 3, i % 3));
    moves = moves & (dot(change, change) > 1e-18);  // the square of this step is left
  }
  return X;
}

/// With the derivative dR = R W: W U + U W = R'dF - dF'R, so that the axial vector w of W solves
/// (tr(U) I - U) w = axial(R'dF - dF'R).
template <class T>
SUTURE_INLINE mat3<dual<T>> polar_rotation(const mat3<dual<T>>& F) {
  mat3<T> value, slope;
  for (int i = 0; i < 9; ++i) {
    value(i / 3, i % 3) = F(i / 3, i % 3).value;
    slope(i / 3, i % 3) = F(i / 3, i % 3).derivative;
  }
  const mat3<T> R = polar_rotation(value), turned = transpose(R) * slope;
  const sym3<T> U = symmetric(transpose(R) * value);
  const vec3<T> axial{turned(2, 1) - turned(1, 2), turned(0, 2) - turned(2, 0),
                      turned(1, 0) - turned(0, 1)};
  const vec3<T> w = inverse(add_diagonal(U * -1.0, trace(U))) * axial;
  mat3<dual<T>> result;
  for (int j = 0; j < 3; ++j) {
    const vec3<T> e{T(j == 0 ? 1.0 : 0.0), T(j == 1 ? 1.0 : 0.0), T(j == 2 ? 1.0 : 0.0)};
    const vec3<T> column = R * cross(w, e);
    for (int i = 0; i < 3; ++i) result(i, j) = {R(i, j), column[i]};
  }
  return result;
}

}  // namespace suture

#endif
