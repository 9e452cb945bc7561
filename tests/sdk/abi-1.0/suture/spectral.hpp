// SPDX-License-Identifier: MIT
//
// suture/spectral.hpp - eigenvalues of symmetric matrices, and functions of them: log(C) / 2 is
// Hencky's strain, sqrt(C) the stretch. For numbers and packs; the functions also for duals, whose
// derivatives are exact where eigenvalues coincide, too.
#ifndef SUTURE_SPECTRAL_HPP
#define SUTURE_SPECTRAL_HPP

#include "suture/tensor.hpp"

namespace suture {

/// A = V diag(values) V'; the columns of V are unit vectors. In no order.
template <class T>
struct eigen_decomposition {
  vec3<T> values;
  mat3<T> vectors;
};

namespace detail {

/// Turns the axes p and q, such that A_pq vanishes (Golub and Van Loan, Matrix Computations, 8.5).
template <class T>
SUTURE_INLINE void turn(mat3<T>& A, mat3<T>& V, int p, int q) {
  const T off = 2.0 * A(p, q), difference = A(q, q) - A(p, p);
  const T size = abs(difference) + sqrt(difference * difference + off * off);
  const T tangent = select(
      size > 0.0, select(difference < 0.0, -off, off) / select(size > 0.0, size, T(1.0)), T(0.0));
  const T cosine = 1.0 / sqrt(tangent * tangent + 1.0), sine = tangent * cosine;
  const auto mix = [&](T& a, T& b) SUTURE_DETAIL_INLINED {
    const T kept = a;
    a = cosine * kept - sine * b;
    b = sine * kept + cosine * b;
  };
  for (int i = 0; i < 3; ++i) mix(A(i, p), A(i, q));
  for (int i = 0; i < 3; ++i) mix(A(p, i), A(q, i));
  for (int i = 0; i < 3; ++i) mix(V(i, p), V(i, q));
}

/// V diag(x) V'
template <class T>
SUTURE_INLINE sym3<T> recomposed(const mat3<T>& V, const vec3<T>& x) {
  sym3<T> sum{};
  for (int k = 0; k < 3; ++k) {
    const vec3<T>& v = V.column[k];
    sum += sym3<T>{v[0] * v[0], v[1] * v[1], v[2] * v[2], v[0] * v[1], v[1] * v[2], v[0] * v[2]} *
           x[k];
  }
  return sum;
}

}  // namespace detail

/// By Jacobi's method. Five sweeps: the error falls with its square or faster in each, and their
/// number does not depend on the values, so that no cell of a pack depends on its neighbours.
template <class T>
SUTURE_INLINE eigen_decomposition<T> eigen(const sym3<T>& a) {
  mat3<T> A = full(a), V = mat3<T>::identity();
  for (int sweep = 0; sweep < 5; ++sweep) {
    detail::turn(A, V, 0, 1);
    detail::turn(A, V, 0, 2);
    detail::turn(A, V, 1, 2);
  }
  return {{A(0, 0), A(1, 1), A(2, 2)}, V};
}

/// f(A) = V diag(f(values)) V'. `slope` is the derivative of f.
template <class T, class F, class Slope>
SUTURE_INLINE sym3<T> isotropic_function(const sym3<T>& A, F&& f, Slope&&) {
  const eigen_decomposition<T> e = eigen(A);
  return detail::recomposed(e.vectors, {f(e.values[0]), f(e.values[1]), f(e.values[2])});
}

/// With the derivative V H V', H_ij = (f(x_i) - f(x_j)) / (x_i - x_j) (V' dA V)_ij (Daleckii and
/// Krein 1965). Quotients of values that differ by less than 2e-5 of them are replaced by the mean
/// slope, which is then accurate to 1e-10.
template <class T, class F, class Slope>
SUTURE_INLINE sym3<dual<T>> isotropic_function(const sym3<dual<T>>& A, F&& f, Slope&& slope) {
  sym3<T> value, change;
  for (int i = 0; i < 6; ++i) value.c[i] = A.c[i].value, change.c[i] = A.c[i].derivative;
  const eigen_decomposition<T> e = eigen(value);
  const mat3<T> turned = transpose(e.vectors) * (full(change) * e.vectors);
  vec3<T> x = e.values, y{f(x[0]), f(x[1]), f(x[2])}, s{slope(x[0]), slope(x[1]), slope(x[2])};
  mat3<T> H;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const T gap = x[i] - x[j];
      const auto close = abs(gap) < 2e-5 * max(abs(x[i]), abs(x[j])) + 1e-300;
      const T quotient = (y[i] - y[j]) / select(close, T(1.0), gap);
      H(i, j) = select(close, 0.5 * (s[i] + s[j]), quotient) * turned(i, j);
    }
  const sym3<T> result = detail::recomposed(e.vectors, y),
                derivative = symmetric(e.vectors * (H * transpose(e.vectors)));
  sym3<dual<T>> both;
  for (int i = 0; i < 6; ++i) both.c[i] = {result.c[i], derivative.c[i]};
  return both;
}

template <class T>
SUTURE_INLINE sym3<T> log(const sym3<T>& A) {
  return isotropic_function(
      A, [](const auto& x) { return log(x); }, [](const auto& x) { return 1.0 / x; });
}
template <class T>
SUTURE_INLINE sym3<T> exp(const sym3<T>& A) {
  return isotropic_function(
      A, [](const auto& x) { return exp(x); }, [](const auto& x) { return exp(x); });
}
template <class T>
SUTURE_INLINE sym3<T> sqrt(const sym3<T>& A) {
  return isotropic_function(
      A, [](const auto& x) { return sqrt(x); }, [](const auto& x) { return 0.5 / sqrt(x); });
}

}  // namespace suture

#endif
