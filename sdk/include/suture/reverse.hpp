// SPDX-License-Identifier: MIT
//
// suture/reverse.hpp - the gradient of a scalar function of a matrix in one pass.
//
//   mat3<T> P = gradient(F, [&](const auto& G) { return energy(G); });
//
// Duals give one directional derivative per evaluation: P = dW/dF would take nine. Reverse
// accumulation (Griewank and Walther, Evaluating Derivatives, 2008, chapter 3) takes one:
// each operation notes on a tape from which operands its result came, and its derivatives by
// them; then the tape is read backwards, with the adjoint dW/d(result) of each operation.
//
// Nothing of the tape is left in the compiled code. The places on it, and which adjoints
// exist, do not depend on values, so that after inlining they are constants: what remains is
// the arithmetic that one would write by hand (neo-Hookean: 100 operations for 89). That
// needs a function which is inlined (SUTURE_INLINE), without loops whose count is large or
// unknown, and GCC: otherwise gradient() uses nine duals, with the same result to rounding.
#ifndef SUTURE_REVERSE_HPP
#define SUTURE_REVERSE_HPP

#include "suture/detail/tape.hpp"

namespace suture {

/// Numbers that are constants beside a variable<T>: plain ones, and those without derivatives.
template <class N, class T>
using if_constant = std::enable_if_t<std::is_arithmetic_v<N> || std::is_same_v<N, real_of<T>>>;

/// A number whose operations are noted on a tape; without one, a constant.
template <class T>
struct variable {
  using R = real_of<T>;
  T value;
  detail::tape<T>* notes = nullptr;
  int place = 0;

  variable() = default;
  SUTURE_INLINE variable(T v) : value(v) {}
  template <class N, class = if_number<N>>
  SUTURE_INLINE variable(N v) : value(T(double(v))) {}
  SUTURE_INLINE variable(T v, detail::tape<T>* t, int p) : value(v), notes(t), place(p) {}

  SUTURE_INLINE variable& operator+=(const variable& b) { return *this = *this + b; }
  SUTURE_INLINE variable& operator-=(const variable& b) { return *this = *this - b; }
  SUTURE_INLINE variable& operator*=(const variable& b) { return *this = *this * b; }
  SUTURE_INLINE variable& operator/=(const variable& b) { return *this = *this / b; }

  friend SUTURE_INLINE variable operator-(const variable& a) {
    return result(-a.value, a.as(minus));
  }
  friend SUTURE_INLINE variable operator+(const variable& a, const variable& b) {
    return noted(a.value + b.value, a.as(plus), b.as(plus));
  }
  friend SUTURE_INLINE variable operator-(const variable& a, const variable& b) {
    return noted(a.value - b.value, a.as(plus), b.as(minus));
  }
  friend SUTURE_INLINE variable operator*(const variable& a, const variable& b) {
    if (a.notes && a.notes == b.notes && a.place == b.place)
      return a.result(a.value * b.value, detail::influence::squared, a.value);
    return noted(a.value * b.value, a.as(weighted, b.value), b.as(weighted, a.value));
  }
  friend SUTURE_INLINE variable operator/(const variable& a, const variable& b) {
    const T inverse = reciprocal(b.value), q = a.value * inverse;
    return noted(q, a.as(singular, inverse), b.as(singular, -(q * inverse)));
  }

  // With a constant.
  template <class N, class = if_constant<N, T>>
  friend SUTURE_INLINE variable operator+(const variable& a, N b) {
    return result(a.value + R(b), a.as(plus));
  }
  template <class N, class = if_constant<N, T>>
  friend SUTURE_INLINE variable operator+(N a, const variable& b) {
    return b + a;
  }
  template <class N, class = if_constant<N, T>>
  friend SUTURE_INLINE variable operator-(const variable& a, N b) {
    return result(a.value - R(b), a.as(plus));
  }
  template <class N, class = if_constant<N, T>>
  friend SUTURE_INLINE variable operator-(N a, const variable& b) {
    return result(R(a) - b.value, b.as(minus));
  }
  template <class N, class = if_constant<N, T>>
  friend SUTURE_INLINE variable operator*(const variable& a, N b) {
    return a.result(a.value * R(b), detail::influence::scaled, T(R(b)));
  }
  template <class N, class = if_constant<N, T>>
  friend SUTURE_INLINE variable operator*(N a, const variable& b) {
    return b * a;
  }
  template <class N, class = if_constant<N, T>>
  friend SUTURE_INLINE variable operator/(const variable& a, N b) {
    if constexpr (std::is_arithmetic_v<N>)
      return a * R(1 / double(b));
    else
      return a * reciprocal(b);
  }
  template <class N, class = if_constant<N, T>>
  friend SUTURE_INLINE variable operator/(N a, const variable& b) {
    const T inverse = reciprocal(b.value), q = R(a) * inverse;
    return b.result(q, singular, -(q * inverse));
  }

  // Comparisons use the value, as those of duals.
  friend SUTURE_INLINE auto operator<(const variable& a, const variable& b) {
    return a.value < b.value;
  }
  friend SUTURE_INLINE auto operator>(const variable& a, const variable& b) {
    return a.value > b.value;
  }
  friend SUTURE_INLINE auto operator<=(const variable& a, const variable& b) {
    return a.value <= b.value;
  }
  friend SUTURE_INLINE auto operator>=(const variable& a, const variable& b) {
    return a.value >= b.value;
  }
  friend SUTURE_INLINE auto operator==(const variable& a, const variable& b) {
    return a.value == b.value;
  }
  friend SUTURE_INLINE auto operator!=(const variable& a, const variable& b) {
    return a.value != b.value;
  }
  template <class Mask>
  friend SUTURE_INLINE variable select(const Mask& m, const variable& a, const variable& b) {
    return noted(select(m, a.value, b.value), a.selected_by(select(m, R(1.0), R(0.0))),
                 b.selected_by(select(m, R(0.0), R(1.0))));
  }
  friend SUTURE_INLINE variable min(const variable& a, const variable& b) {
    return select(a < b, a, b);
  }
  friend SUTURE_INLINE variable max(const variable& a, const variable& b) {
    return select(a > b, a, b);
  }

  /// The result of an operation on this number alone, and its derivative.
  SUTURE_INLINE variable result(T v, detail::influence kind, T derivative) const {
    return result(v, as(kind, derivative));
  }
  static constexpr auto plus = detail::influence::same, minus = detail::influence::opposite,
                        weighted = detail::influence::weighted,
                        singular = detail::influence::singular;

 private:
  template <class Weight = detail::no_weight>
  SUTURE_INLINE detail::relation<T, Weight> as(detail::influence kind, Weight weight = {}) const {
    return {notes, notes ? 16 * place + 2 * int(kind) : 0, weight};
  }
  SUTURE_INLINE detail::relation<T, T> selected_by(const R& scale) const {
    return {notes, notes ? 16 * place + 2 * int(detail::influence::scaled) + 1 : 0, T(scale)};
  }
  template <class A>
  static SUTURE_INLINE variable result(T value, const detail::relation<T, A>& a) {
    return noted(value, a, detail::no_relation<T>());
  }
  template <class A, class B>
  static SUTURE_INLINE variable noted(T value, const detail::relation<T, A>& a,
                                      const detail::relation<T, B>& b) {
    detail::tape<T>* const notes = a.notes ? a.notes : b.notes;
    if (!notes) return value;
    return {value, notes, note(*notes, a, b)};
  }
};

// -------------------------------------------------------------- functions --

template <class T>
SUTURE_INLINE variable<T> abs(const variable<T>& a) {
  using R = real_of<T>;
  return a.result(abs(a.value), detail::influence::scaled,
                  T(select(a.value < T(0.0), R(-1.0), R(1.0))));
}
template <class T>
SUTURE_INLINE variable<T> reciprocal(const variable<T>& a) {
  return 1.0 / a;
}
template <class T>
SUTURE_INLINE variable<T> sqrt(const variable<T>& a) {
  const T root = sqrt(a.value);
  return a.result(root, a.singular, 0.5 * reciprocal(root));
}
template <class T>
SUTURE_INLINE variable<T> rsqrt(const variable<T>& a) {
  const T r = rsqrt(a.value);
  return a.result(r, a.singular, -0.5 * (r * r * r));
}
template <class T>
SUTURE_INLINE variable<T> exp(const variable<T>& a) {
  const T e = exp(a.value);
  return a.result(e, a.singular, e);
}
template <class T>
SUTURE_INLINE variable<T> expm1(const variable<T>& a) {
  const T e = expm1(a.value);
  return a.result(e, a.singular, e + 1.0);
}
template <class T>
SUTURE_INLINE variable<T> log(const variable<T>& a) {
  return a.result(log(a.value), a.singular, reciprocal(a.value));
}
template <class T>
SUTURE_INLINE variable<T> log1p(const variable<T>& a) {
  return a.result(log1p(a.value), a.singular, reciprocal(a.value + 1.0));
}
template <class T>
SUTURE_INLINE variable<T> cbrt(const variable<T>& a) {
  const T r = cbrt(a.value);
  return a.result(r, a.singular, reciprocal(3.0 * r * r));
}
template <class T>
SUTURE_INLINE variable<T> pow(const variable<T>& a, double b) {
  return a.result(pow(a.value, b), a.singular, b * pow(a.value, b - 1));
}
template <class T>
SUTURE_INLINE variable<T> sin(const variable<T>& a) {
  return a.result(sin(a.value), a.weighted, cos(a.value));
}
template <class T>
SUTURE_INLINE variable<T> cos(const variable<T>& a) {
  return a.result(cos(a.value), a.weighted, -sin(a.value));
}
template <class T>
SUTURE_INLINE variable<T> tanh(const variable<T>& a) {
  const T t = tanh(a.value);
  return a.result(t, a.weighted, 1.0 - t * t);
}

template <class T>
inline constexpr bool is_scalar<variable<T>> = true;
template <class T>
struct real_part<variable<T>> : real_part<T> {};
template <class T>
SUTURE_INLINE const real_of<T>& real(const variable<T>& a) {
  return real(a.value);
}

// --------------------------------------------------------------- gradient --

namespace detail {

/// The inputs of a tape: F_ij at place i + 3 j.
template <class T>
SUTURE_INLINE mat3<variable<T>> inputs_of(tape<T>& notes, const mat3<T>& F) {
  notes.size = 9;
  const auto input = [&](int i, int j) SUTURE_DETAIL_INLINED -> variable<T> {
    return {F(i, j), &notes, i + 3 * j};
  };
  return {{{input(0, 0), input(1, 0), input(2, 0)},
           {input(0, 1), input(1, 1), input(2, 1)},
           {input(0, 2), input(1, 2), input(2, 2)}}};
}

/// The derivatives of a result by the inputs. A loop: GCC unrolls it when it knows the size of the
/// tape. Written as a sequence of calls, it would be worked through for the longest tape, twice.
template <class T>
SUTURE_INLINE mat3<T> gradient_of(const tape<T>& notes, const variable<T>& result) {
  adjoints<T> adjoint;
  if (result.notes) adjoint.add(result.place, T(1.0), 0);
#pragma GCC unroll 160
  for (int place = notes.size - 1; place >= 9; --place) adjoint.pass_on(place, notes);
  const auto output = [&](int i) SUTURE_DETAIL_INLINED {
    return adjoint.state[i] ? adjoint.value[i] : T(0.0);
  };
  return {{{output(0), output(1), output(2)},
           {output(3), output(4), output(5)},
           {output(6), output(7), output(8)}}};
}

}  // namespace detail

/// dW/dF of W(F). W is called with matrices of other scalar types; declare it always_inline. Not
/// inlined itself: at each Gauss point of each functor it would take the compiler half a minute.
template <class T, class Function>
[[gnu::noinline]] mat3<T> gradient(const mat3<T>& F, Function&& W) {
#if defined(__clang__)  // which leaves the tape in memory
  return detail::gradient_by_duals(F, W);
#else
  detail::tape<T> notes;
  const variable<T> result = W(detail::inputs_of(notes, F));
  // Constant if the whole tape is.
  if (!__builtin_constant_p(notes.size) || notes.size > detail::tape<T>::capacity)
    return detail::gradient_by_duals(F, W);
  return detail::gradient_of(notes, result);
#endif
}

}  // namespace suture

#endif
