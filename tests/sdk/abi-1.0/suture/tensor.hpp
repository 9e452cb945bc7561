// SPDX-License-Identifier: MIT
//
// suture/tensor.hpp - vectors and matrices in three dimensions, written as in
// formulas. T is double, a pack or a dual; operands of different scalar types mix
// (a rest length is never a dual, a position may be one).
//
// Everything is inlined and its loops have constant bounds: after optimisation
// only the arithmetic is left.
#ifndef SUTURE_TENSOR_HPP
#define SUTURE_TENSOR_HPP

#include "suture/dual.hpp"

namespace suture {

template <class T>
inline constexpr bool is_scalar = std::is_arithmetic_v<T> || is_pack<T> || is_dual<T>;

/// Type of a*b.
template <class A, class B>
using product = std::decay_t<decltype(std::declval<A>() * std::declval<B>())>;
template <class S>
using if_scalar = std::enable_if_t<is_scalar<S>>;

// ------------------------------------------------------------------ vec3 --

template <class T>
struct vec3 {
  T c[3];
  SUTURE_INLINE T& operator[](int i) { return c[i]; }
  SUTURE_INLINE const T& operator[](int i) const { return c[i]; }
  template <class U>
  SUTURE_INLINE vec3& operator+=(const vec3<U>& b) {
    return *this = *this + b;
  }
  template <class U>
  SUTURE_INLINE vec3& operator-=(const vec3<U>& b) {
    return *this = *this - b;
  }
};

template <class T>
SUTURE_INLINE vec3<T> operator-(const vec3<T>& a) {
  return {-a[0], -a[1], -a[2]};
}
template <class A, class B>
SUTURE_INLINE vec3<product<A, B>> operator+(const vec3<A>& a, const vec3<B>& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
template <class A, class B>
SUTURE_INLINE vec3<product<A, B>> operator-(const vec3<A>& a, const vec3<B>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class A, class S, class = if_scalar<S>>
SUTURE_INLINE vec3<product<A, S>> operator*(const vec3<A>& a, const S& s) {
  return {a[0] * s, a[1] * s, a[2] * s};
}
template <class A, class S, class = if_scalar<S>>
SUTURE_INLINE vec3<product<A, S>> operator*(const S& s, const vec3<A>& a) {
  return a * s;
}

template <class A, class B>
SUTURE_INLINE product<A, B> dot(const vec3<A>& a, const vec3<B>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class A, class B>
SUTURE_INLINE vec3<product<A, B>> cross(const vec3<A>& a, const vec3<B>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class T>
SUTURE_INLINE T norm(const vec3<T>& a) {
  return sqrt(dot(a, a));
}

// ------------------------------------------------------------------ mat3 --

/// Three columns; m(i, j) is row i, column j.
template <class T>
struct mat3 {
  vec3<T> column[3];
  SUTURE_INLINE T& operator()(int i, int j) { return column[j][i]; }
  SUTURE_INLINE const T& operator()(int i, int j) const { return column[j][i]; }
  template <class U>
  SUTURE_INLINE mat3& operator+=(const mat3<U>& b) {
    return *this = *this + b;
  }
  static SUTURE_INLINE mat3 identity() {
    return {{{{1.0, 0.0, 0.0}}, {{0.0, 1.0, 0.0}}, {{0.0, 0.0, 1.0}}}};
  }
};

template <class A, class B>
SUTURE_INLINE mat3<product<A, B>> operator+(const mat3<A>& a, const mat3<B>& b) {
  return {{a.column[0] + b.column[0], a.column[1] + b.column[1], a.column[2] + b.column[2]}};
}
template <class A, class B>
SUTURE_INLINE mat3<product<A, B>> operator-(const mat3<A>& a, const mat3<B>& b) {
  return {{a.column[0] - b.column[0], a.column[1] - b.column[1], a.column[2] - b.column[2]}};
}
template <class A, class S, class = if_scalar<S>>
SUTURE_INLINE mat3<product<A, S>> operator*(const mat3<A>& a, const S& s) {
  return {{a.column[0] * s, a.column[1] * s, a.column[2] * s}};
}
template <class A, class S, class = if_scalar<S>>
SUTURE_INLINE mat3<product<A, S>> operator*(const S& s, const mat3<A>& a) {
  return a * s;
}
template <class A, class B>
SUTURE_INLINE vec3<product<A, B>> operator*(const mat3<A>& a, const vec3<B>& b) {
  return a.column[0] * b[0] + a.column[1] * b[1] + a.column[2] * b[2];
}
template <class A, class B>
SUTURE_INLINE mat3<product<A, B>> operator*(const mat3<A>& a, const mat3<B>& b) {
  return {{a * b.column[0], a * b.column[1], a * b.column[2]}};
}
template <class T>
SUTURE_INLINE mat3<T> transpose(const mat3<T>& a) {
  return {{{{a(0, 0), a(0, 1), a(0, 2)}},
           {{a(1, 0), a(1, 1), a(1, 2)}},
           {{a(2, 0), a(2, 1), a(2, 2)}}}};
}
/// Double contraction A : B = sum A_ij B_ij.
template <class A, class B>
SUTURE_INLINE product<A, B> dot(const mat3<A>& a, const mat3<B>& b) {
  return dot(a.column[0], b.column[0]) + dot(a.column[1], b.column[1]) +
         dot(a.column[2], b.column[2]);
}
template <class T>
SUTURE_INLINE T trace(const mat3<T>& a) {
  return a(0, 0) + a(1, 1) + a(2, 2);
}
template <class T>
SUTURE_INLINE T det(const mat3<T>& a) {
  return dot(a.column[0], cross(a.column[1], a.column[2]));
}
/// Cofactor matrix det(A) A^-T: its columns are the cross products of A's.
template <class T>
SUTURE_INLINE mat3<T> cofactor(const mat3<T>& a) {
  return {{cross(a.column[1], a.column[2]), cross(a.column[2], a.column[0]),
           cross(a.column[0], a.column[1])}};
}
template <class T>
SUTURE_INLINE mat3<T> inverse(const mat3<T>& a) {
  const mat3<T> c = cofactor(a);
  return transpose(c) * (1.0 / dot(a.column[0], c.column[0]));
}

// ------------------------------------------------------------------ sym3 --

/// Symmetric matrix in the order of output fields: XX YY ZZ XY YZ XZ.
template <class T>
struct sym3 {
  T c[6];
  static constexpr int index(int i, int j) {
    return i == j ? i : i + j == 1 ? 3 : i + j == 3 ? 4 : 5;
  }
  SUTURE_INLINE T& operator()(int i, int j) { return c[index(i, j)]; }
  SUTURE_INLINE const T& operator()(int i, int j) const { return c[index(i, j)]; }
  SUTURE_INLINE vec3<T> column(int j) const {
    return {(*this)(0, j), (*this)(1, j), (*this)(2, j)};
  }
  template <class U>
  SUTURE_INLINE sym3& operator+=(const sym3<U>& b) {
    return *this = *this + b;
  }
  static SUTURE_INLINE sym3 identity() { return {1.0, 1.0, 1.0, 0.0, 0.0, 0.0}; }
};

template <class A, class B>
SUTURE_INLINE sym3<product<A, B>> operator+(const sym3<A>& a, const sym3<B>& b) {
  return {a.c[0] + b.c[0], a.c[1] + b.c[1], a.c[2] + b.c[2],
          a.c[3] + b.c[3], a.c[4] + b.c[4], a.c[5] + b.c[5]};
}
template <class A, class B>
SUTURE_INLINE sym3<product<A, B>> operator-(const sym3<A>& a, const sym3<B>& b) {
  return {a.c[0] - b.c[0], a.c[1] - b.c[1], a.c[2] - b.c[2],
          a.c[3] - b.c[3], a.c[4] - b.c[4], a.c[5] - b.c[5]};
}
template <class A, class S, class = if_scalar<S>>
SUTURE_INLINE sym3<product<A, S>> operator*(const sym3<A>& a, const S& s) {
  return {a.c[0] * s, a.c[1] * s, a.c[2] * s, a.c[3] * s, a.c[4] * s, a.c[5] * s};
}
template <class A, class S, class = if_scalar<S>>
SUTURE_INLINE sym3<product<A, S>> operator*(const S& s, const sym3<A>& a) {
  return a * s;
}
template <class A, class B>
SUTURE_INLINE mat3<product<A, B>> operator*(const mat3<A>& a, const sym3<B>& b) {
  return {{a * b.column(0), a * b.column(1), a * b.column(2)}};
}
template <class A, class B>
SUTURE_INLINE vec3<product<A, B>> operator*(const sym3<A>& a, const vec3<B>& b) {
  return a.column(0) * b[0] + a.column(1) * b[1] + a.column(2) * b[2];
}
template <class T>
SUTURE_INLINE mat3<T> full(const sym3<T>& a) {
  return {{a.column(0), a.column(1), a.column(2)}};
}
/// (A + A') / 2
template <class T>
SUTURE_INLINE sym3<T> symmetric(const mat3<T>& a) {
  return {a(0, 0),
          a(1, 1),
          a(2, 2),
          0.5 * (a(0, 1) + a(1, 0)),
          0.5 * (a(1, 2) + a(2, 1)),
          0.5 * (a(0, 2) + a(2, 0))};
}
template <class T>
SUTURE_INLINE T trace(const sym3<T>& a) {
  return a.c[0] + a.c[1] + a.c[2];
}
/// det(A) A^-1
template <class T>
SUTURE_INLINE sym3<T> cofactor(const sym3<T>& a) {
  const T(&c)[6] = a.c;
  return {c[1] * c[2] - c[4] * c[4], c[0] * c[2] - c[5] * c[5], c[0] * c[1] - c[3] * c[3],
          c[4] * c[5] - c[3] * c[2], c[3] * c[5] - c[4] * c[0], c[3] * c[4] - c[5] * c[1]};
}
template <class T>
SUTURE_INLINE T det(const sym3<T>& a) {
  const sym3<T> cof = cofactor(a);
  return a.c[0] * cof.c[0] + a.c[3] * cof.c[3] + a.c[5] * cof.c[5];
}
template <class T>
SUTURE_INLINE sym3<T> inverse(const sym3<T>& a) {
  const sym3<T> cof = cofactor(a);
  return cof * reciprocal(a.c[0] * cof.c[0] + a.c[3] * cof.c[3] + a.c[5] * cof.c[5]);
}
template <class A, class B>
SUTURE_INLINE product<A, B> dot(const sym3<A>& a, const sym3<B>& b) {
  return a.c[0] * b.c[0] + a.c[1] * b.c[1] + a.c[2] * b.c[2] +
         2.0 * (a.c[3] * b.c[3] + a.c[4] * b.c[4] + a.c[5] * b.c[5]);
}
/// A with `s` added to its diagonal.
template <class A, class S>
SUTURE_INLINE sym3<product<A, S>> add_diagonal(const sym3<A>& a, const S& s) {
  return {a.c[0] + s, a.c[1] + s, a.c[2] + s, a.c[3] * 1.0, a.c[4] * 1.0, a.c[5] * 1.0};
}

/// F'F - I, twice the Green-Lagrange strain E. The diagonal starts from -1, so
/// that small strains keep their digits and each entry takes three operations.
template <class T>
SUTURE_INLINE sym3<T> twice_green_strain(const mat3<T>& F) {
  const auto& f = F.column;
  const auto square = [](const vec3<T>& a) SUTURE_DETAIL_INLINED {
    return ((a[0] * a[0] - 1.0) + a[1] * a[1]) + a[2] * a[2];
  };
  return {square(f[0]),    square(f[1]),    square(f[2]),
          dot(f[0], f[1]), dot(f[1], f[2]), dot(f[0], f[2])};
}
/// Green-Lagrange strain E = (F'F - I) / 2.
template <class T>
SUTURE_INLINE sym3<T> green_strain(const mat3<T>& F) {
  return twice_green_strain(F) * 0.5;
}

/// Right Cauchy-Green tensor C = F'F.
template <class T>
SUTURE_INLINE sym3<T> right_cauchy_green(const mat3<T>& F) {
  const auto& f = F.column;
  return {dot(f[0], f[0]), dot(f[1], f[1]), dot(f[2], f[2]),
          dot(f[0], f[1]), dot(f[1], f[2]), dot(f[0], f[2])};
}

/// Cauchy stress P F' / J of the first Piola-Kirchhoff stress P.
template <class T>
SUTURE_INLINE sym3<T> cauchy(const mat3<T>& P, const mat3<T>& F) {
  const T inverse_j = 1.0 / det(F);
  const mat3<T> s = P * transpose(F) * inverse_j;
  return {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(0, 2)};
}

/// Equivalent stress of von Mises, sqrt(3/2 s:s) with the deviator s.
template <class T>
SUTURE_INLINE T von_mises(const sym3<T>& a) {
  const sym3<T> s = add_diagonal(a, trace(a) * (-1.0 / 3.0));
  return sqrt(1.5 * dot(s, s));
}

}  // namespace suture

#endif
