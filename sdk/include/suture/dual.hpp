// SPDX-License-Identifier: MIT
//
// suture/dual.hpp - exact directional derivatives of any templated function.
//
// dual<T> is a + b eps with eps^2 = 0. Evaluated on x + dx eps, a function
// returns f(x) + (df/dx dx) eps: the value and the directional derivative, exact
// to rounding, with no step to choose (Griewank and Walther, Evaluating
// Derivatives, 2008, chapter 3).
//
//   dual<double> x{3.0, 1.0};            // dx = 1
//   auto y = x * x * x;                  // y.value = 27, y.derivative = 27
//
// T is double, a pack, or again a dual (second derivatives). With it the layer
// obtains the tangent from the force, the stress from an energy density, and the
// tangent of that stress.
#ifndef SUTURE_DUAL_HPP
#define SUTURE_DUAL_HPP

#include "suture/elementary.hpp"

namespace suture {

template <class N>
using if_number = std::enable_if_t<std::is_arithmetic_v<N>>;

template <class T>
struct dual {
  T value;
  T derivative;

  dual() = default;
  SUTURE_INLINE dual(T v) : value(v), derivative(0.0) {}  // a constant
  SUTURE_INLINE dual(T v, T d) : value(v), derivative(d) {}
  template <class N, class = if_number<N>>
  SUTURE_INLINE dual(N v) : value(double(v)), derivative(0.0) {}

  SUTURE_INLINE dual& operator+=(const dual& b) { return *this = *this + b; }
  SUTURE_INLINE dual& operator-=(const dual& b) { return *this = *this - b; }
  SUTURE_INLINE dual& operator*=(const dual& b) { return *this = *this * b; }
  SUTURE_INLINE dual& operator/=(const dual& b) { return *this = *this / b; }

  friend SUTURE_INLINE dual operator-(const dual& a) { return {-a.value, -a.derivative}; }
  friend SUTURE_INLINE dual operator+(const dual& a, const dual& b) {
    return {a.value + b.value, a.derivative + b.derivative};
  }
  friend SUTURE_INLINE dual operator-(const dual& a, const dual& b) {
    return {a.value - b.value, a.derivative - b.derivative};
  }
  friend SUTURE_INLINE dual operator*(const dual& a, const dual& b) {
    return {a.value * b.value, a.derivative * b.value + a.value * b.derivative};
  }
  friend SUTURE_INLINE dual operator/(const dual& a, const dual& b) {
    const T q = a.value / b.value;
    return {q, (a.derivative - q * b.derivative) / b.value};
  }

  // With a constant, which has no derivative.
  friend SUTURE_INLINE dual operator+(const dual& a, T b) { return {a.value + b, a.derivative}; }
  friend SUTURE_INLINE dual operator+(T a, const dual& b) { return {a + b.value, b.derivative}; }
  friend SUTURE_INLINE dual operator-(const dual& a, T b) { return {a.value - b, a.derivative}; }
  friend SUTURE_INLINE dual operator-(T a, const dual& b) { return {a - b.value, -b.derivative}; }
  friend SUTURE_INLINE dual operator*(const dual& a, T b) {
    return {a.value * b, a.derivative * b};
  }
  friend SUTURE_INLINE dual operator*(T a, const dual& b) {
    return {a * b.value, a * b.derivative};
  }
  friend SUTURE_INLINE dual operator/(const dual& a, T b) { return a * (1.0 / b); }
  friend SUTURE_INLINE dual operator/(T a, const dual& b) { return dual(a) / b; }

  // With a plain number.
  template <class N, class = if_number<N>>
  friend SUTURE_INLINE dual operator+(const dual& a, N b) {
    return a + T(double(b));
  }
  template <class N, class = if_number<N>>
  friend SUTURE_INLINE dual operator+(N a, const dual& b) {
    return T(double(a)) + b;
  }
  template <class N, class = if_number<N>>
  friend SUTURE_INLINE dual operator-(const dual& a, N b) {
    return a - T(double(b));
  }
  template <class N, class = if_number<N>>
  friend SUTURE_INLINE dual operator-(N a, const dual& b) {
    return T(double(a)) - b;
  }
  template <class N, class = if_number<N>>
  friend SUTURE_INLINE dual operator*(const dual& a, N b) {
    return a * T(double(b));
  }
  template <class N, class = if_number<N>>
  friend SUTURE_INLINE dual operator*(N a, const dual& b) {
    return T(double(a)) * b;
  }
  template <class N, class = if_number<N>>
  friend SUTURE_INLINE dual operator/(const dual& a, N b) {
    return a * T(1 / double(b));
  }
  template <class N, class = if_number<N>>
  friend SUTURE_INLINE dual operator/(N a, const dual& b) {
    return dual(T(double(a))) / b;
  }

  // Comparisons and select() use the value; the derivative goes with the selected value.
  friend SUTURE_INLINE auto operator<(const dual& a, const dual& b) { return a.value < b.value; }
  friend SUTURE_INLINE auto operator>(const dual& a, const dual& b) { return a.value > b.value; }
  friend SUTURE_INLINE auto operator<=(const dual& a, const dual& b) { return a.value <= b.value; }
  friend SUTURE_INLINE auto operator>=(const dual& a, const dual& b) { return a.value >= b.value; }
  friend SUTURE_INLINE auto operator==(const dual& a, const dual& b) { return a.value == b.value; }
  friend SUTURE_INLINE auto operator!=(const dual& a, const dual& b) { return a.value != b.value; }
  template <class Mask>
  friend SUTURE_INLINE dual select(const Mask& m, const dual& a, const dual& b) {
    return {select(m, a.value, b.value), select(m, a.derivative, b.derivative)};
  }
  friend SUTURE_INLINE dual min(const dual& a, const dual& b) { return select(a < b, a, b); }
  friend SUTURE_INLINE dual max(const dual& a, const dual& b) { return select(a > b, a, b); }
  friend SUTURE_INLINE dual abs(const dual& a) { return select(a < dual(0.0), -a, a); }

  friend SUTURE_INLINE dual reciprocal(const dual& a) {
    const T r = reciprocal(a.value);
    return {r, -(r * r) * a.derivative};
  }
  friend SUTURE_INLINE dual sqrt(const dual& a) {
    const T root = sqrt(a.value);
    return {root, a.derivative / (2.0 * root)};
  }
  /// d x^(-1/2) = -1/2 x^(-3/2) dx
  friend SUTURE_INLINE dual rsqrt(const dual& a) {
    const T r = rsqrt(a.value);
    return {r, -0.5 * (r * r * r) * a.derivative};
  }
  friend SUTURE_INLINE dual exp(const dual& a) {
    const T e = exp(a.value);
    return {e, e * a.derivative};
  }
  friend SUTURE_INLINE dual expm1(const dual& a) {
    const T e = expm1(a.value);
    return {e, (e + 1.0) * a.derivative};
  }
  friend SUTURE_INLINE dual log(const dual& a) { return {log(a.value), a.derivative / a.value}; }
  friend SUTURE_INLINE dual log1p(const dual& a) {
    return {log1p(a.value), a.derivative / (a.value + 1.0)};
  }
  friend SUTURE_INLINE dual cbrt(const dual& a) {
    const T r = cbrt(a.value);
    return {r, a.derivative / (3.0 * r * r)};
  }
  friend SUTURE_INLINE dual pow(const dual& a, double b) {
    return {pow(a.value, b), b * pow(a.value, b - 1) * a.derivative};
  }
  friend SUTURE_INLINE dual sin(const dual& a) {
    return {sin(a.value), cos(a.value) * a.derivative};
  }
  friend SUTURE_INLINE dual cos(const dual& a) {
    return {cos(a.value), -sin(a.value) * a.derivative};
  }
  friend SUTURE_INLINE dual tanh(const dual& a) {
    const T t = tanh(a.value);
    return {t, (1.0 - t * t) * a.derivative};
  }
};

/// The real type that underlies (nested) duals: double or a pack.
template <class T>
struct real_part {
  using type = T;
};
template <class T>
struct real_part<dual<T>> : real_part<T> {};
template <class T>
using real_of = typename real_part<T>::type;

template <class T>
inline constexpr bool is_dual = false;
template <class T>
inline constexpr bool is_dual<dual<T>> = true;

/// The value without its derivatives.
template <class T>
SUTURE_INLINE const T& real(const T& a) {
  return a;
}
template <class T>
SUTURE_INLINE const real_of<T>& real(const dual<T>& a) {
  return real(a.value);
}

}  // namespace suture

#endif
