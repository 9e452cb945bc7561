// SPDX-License-Identifier: MIT
//
// suture/simd.hpp - pack<N>: N doubles, or pack<N, float>: N floats, side by side that behave as
// one number.
//
// A model's functions are written for a scalar type T, as if for one cell. The
// layer calls them with T = pack<native_lanes>, so that every line works on as
// many cells as a register of the instruction set holds; T = double works in the
// same templates and is the reference for tests.
//
//   template <class T> T energy(T k, T length, T rest) {
//     const T stretch = length - rest;
//     return 0.5 * k * stretch * stretch;      // doubles mix with T
//   }
//
// There are no branches on values: both sides are computed and select() takes
// one of them per lane. Arithmetic is that of IEEE 754 in every lane; a NaN in
// one lane stays in that lane. elementary.hpp adds exp, log, pow and the like.
//
// The batch has SUTURE_LANES = 8 cells whatever the instruction set is. With
// AVX-512 one pack is a batch, with AVX2 a batch is two packs, with SSE2 four:
// packs wider than a register would live in memory (measured on a StVK
// hexahedron: 1.6 times slower with AVX2).
#ifndef SUTURE_SIMD_HPP
#define SUTURE_SIMD_HPP

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#if defined(__AVX__)
#include <immintrin.h>
#endif

#include "suture/plugin.h"
#include "suture/single.h"

// Sanitizers multiply the statements of whatever is inlined by force: a law would take ten
// minutes to compile.
#if defined(__has_feature)
#define SUTURE_DETAIL_FEATURE(name) __has_feature(name)
#else
#define SUTURE_DETAIL_FEATURE(name) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || \
    SUTURE_DETAIL_FEATURE(address_sanitizer) || SUTURE_DETAIL_FEATURE(thread_sanitizer)
#define SUTURE_DETAIL_INLINED
#define SUTURE_DETAIL_FLATTENED
#else
#define SUTURE_DETAIL_INLINED __attribute__((always_inline))
#define SUTURE_DETAIL_FLATTENED __attribute__((flatten))
#endif
#define SUTURE_INLINE inline SUTURE_DETAIL_INLINED
#if defined(__clang__)
#define SUTURE_DETAIL_ROLLED _Pragma("nounroll")
#else
#define SUTURE_DETAIL_ROLLED _Pragma("GCC unroll 1")
#endif

namespace suture {

/// Number of doubles in a register of the instruction set for which this is compiled.
#if defined(__AVX512F__)
inline constexpr int native_lanes = 8;
#elif defined(__AVX__)
inline constexpr int native_lanes = 4;
#else
inline constexpr int native_lanes = 2;
#endif
static_assert(SUTURE_LANES % native_lanes == 0,
              "SUTURE_LANES must be a multiple of the number of lanes of a pack");

/// The compiler's vector extension; GCC requires element and length to be dependent.
template <class E, int N>
struct vector_extension {
  using type [[gnu::vector_size(N * sizeof(E))]] = E;
};
template <class E, int N>
using vector_of = typename vector_extension<E, N>::type;

/// N numbers; every operation acts on each lane separately.
template <int N, class E = double>
struct pack {
  using vector = vector_of<E, N>;
  using integer = std::conditional_t<sizeof(E) == 8, std::int64_t, std::int32_t>;
  using integers = vector_of<integer, N>;

  /// Result of a comparison: all bits set in the lanes where it holds.
  struct mask {
    integers bits;
    friend SUTURE_INLINE mask operator&(mask a, mask b) { return {a.bits & b.bits}; }
    friend SUTURE_INLINE mask operator|(mask a, mask b) { return {a.bits | b.bits}; }
    friend SUTURE_INLINE mask operator!(mask a) { return {~a.bits}; }
    bool operator[](int lane) const { return bits[lane] != 0; }
    /// What `if`, `? :`, `&&` and `||` would call. A template, so that it is an error only there.
    template <class Bool, class = std::enable_if_t<std::is_same_v<Bool, bool>>>
    explicit operator Bool() const {
      static_assert(!std::is_same_v<Bool, bool>,
                    "the cells of a pack may differ in this condition, so no `if`, `? :`, `&&` or "
                    "`||` can follow it: compute both values and write `select(a < b, x, y)`, "
                    "join conditions by `&` and `|`, and ask `any(a < b)` or `all(a < b)` for one "
                    "answer");
      return false;
    }
  };

  vector v;

  pack() = default;
  SUTURE_INLINE pack(vector values) : v(values) {}
  SUTURE_INLINE pack(double value) : v(E(value) - vector{}) {}  // in all lanes; -0 stays -0

  /// Reads or writes N numbers; `p` is aligned to the pack.
  static SUTURE_INLINE pack load(const E* p) {
    return *static_cast<const vector*>(__builtin_assume_aligned(p, sizeof(vector)));
  }
  SUTURE_INLINE void store(E* p) const {
    *static_cast<vector*>(__builtin_assume_aligned(p, sizeof(vector))) = v;
  }
  double operator[](int lane) const { return v[lane]; }

  SUTURE_INLINE pack& operator+=(pack b) {
    v += b.v;
    return *this;
  }
  SUTURE_INLINE pack& operator-=(pack b) {
    v -= b.v;
    return *this;
  }
  SUTURE_INLINE pack& operator*=(pack b) {
    v *= b.v;
    return *this;
  }
  SUTURE_INLINE pack& operator/=(pack b) {
    v /= b.v;
    return *this;
  }
  friend SUTURE_INLINE pack operator-(pack a) { return -a.v; }
  friend SUTURE_INLINE pack operator+(pack a, pack b) { return a.v + b.v; }
  friend SUTURE_INLINE pack operator-(pack a, pack b) { return a.v - b.v; }
  friend SUTURE_INLINE pack operator*(pack a, pack b) { return a.v * b.v; }
  friend SUTURE_INLINE pack operator/(pack a, pack b) { return a.v / b.v; }
  friend SUTURE_INLINE mask operator<(pack a, pack b) { return {a.v < b.v}; }
  friend SUTURE_INLINE mask operator>(pack a, pack b) { return {a.v > b.v}; }
  friend SUTURE_INLINE mask operator<=(pack a, pack b) { return {a.v <= b.v}; }
  friend SUTURE_INLINE mask operator>=(pack a, pack b) { return {a.v >= b.v}; }
  friend SUTURE_INLINE mask operator==(pack a, pack b) { return {a.v == b.v}; }
  friend SUTURE_INLINE mask operator!=(pack a, pack b) { return {a.v != b.v}; }

  /// Per lane: m ? a : b.
  friend SUTURE_INLINE pack select(mask m, pack a, pack b) { return m.bits ? a.v : b.v; }
  friend SUTURE_INLINE pack min(pack a, pack b) { return a.v < b.v ? a.v : b.v; }
  friend SUTURE_INLINE pack max(pack a, pack b) { return a.v > b.v ? a.v : b.v; }
  friend SUTURE_INLINE pack abs(pack a) {
    return vector(integers(a.v) & std::numeric_limits<integer>::max());
  }
  friend SUTURE_INLINE bool any(mask m) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
    if constexpr (N == 8 && sizeof(E) == 8) return _mm512_movepi64_mask(__m512i(m.bits)) != 0;
#endif
#if defined(__AVX__)
    if constexpr (N == 4 && sizeof(E) == 8) return _mm256_movemask_pd(__m256d(m.bits)) != 0;
#endif
    integer bits = 0;
    for (int lane = 0; lane < N; ++lane) bits |= m.bits[lane];
    return bits != 0;
  }
  friend SUTURE_INLINE bool all(mask m) { return !any(!m); }

  friend SUTURE_INLINE pack sqrt(pack a) {
    return map(a, [](E x) { return std::sqrt(x); });
  }

  template <class F>
  static SUTURE_INLINE pack map(pack a, F&& f) {
    vector result;
    for (int lane = 0; lane < N; ++lane) result[lane] = f(a.v[lane]);
    return result;
  }
};

/// The packs that fill one register.
using native = pack<native_lanes>;
using native_single = pack<2 * native_lanes, float>;
static_assert(SUTURE_SINGLE_LANES % (2 * native_lanes) == 0,
              "SUTURE_SINGLE_LANES must be a multiple of the number of lanes of a pack");

// The same functions for one double.
SUTURE_INLINE double select(bool m, double a, double b) { return m ? a : b; }
SUTURE_INLINE double min(double a, double b) { return a < b ? a : b; }
SUTURE_INLINE double max(double a, double b) { return a > b ? a : b; }
SUTURE_INLINE bool any(bool m) { return m; }
SUTURE_INLINE bool all(bool m) { return m; }
using std::abs;
using std::sqrt;

/// 1/sqrt(x) for normal x > 0, to 2 units in the last place; the result for a NaN or
/// an infinity is not finite. Cheaper than a division by a root: no operation of the
/// sequence occupies the divider.
///
/// An estimate y of relative error d is improved with e = 1 - x y^2:
///   x^(-1/2) = y (1 - e)^(-1/2) = y (1 + e/2 + 3/8 e^2 + 5/16 e^3 + ...)
/// AVX-512 starts from an instruction with d < 2^-14; one step to e^3 leaves
/// 35/128 e^4 < 6e-17. Otherwise the start is the linear function of the exponent
/// and mantissa bits (d < 0.035; Lomont 2003), and two steps are made.
SUTURE_INLINE double rsqrt(double x) { return 1 / std::sqrt(x); }

template <int N>
SUTURE_INLINE pack<N> rsqrt(pack<N> x) {
  const auto improve = [x](pack<N> y) {
    const pack<N> e = 1.0 - x * (y * y);
    return y + y * e * (0.5 + e * (0.375 + 0.3125 * e));
  };
#if defined(__AVX512F__)
  if constexpr (N == 8)
    return improve(typename pack<N>::vector(_mm512_maskz_rsqrt14_pd(0xff, __m512d(x.v))));
#endif
  using vector = typename pack<N>::vector;
  using integers = typename pack<N>::integers;
  using unsigneds = vector_of<std::uint64_t, N>;
  const integers bits = 0x5fe6eb50c7b537a9 - integers(unsigneds(x.v) >> 1);
  return improve(improve(pack<N>(vector(bits))));
}

/// The same for floats: the compiler's root and division are as fast as any refinement.
template <int N>
SUTURE_INLINE pack<N, float> rsqrt(pack<N, float> x) {
  return 1.0 / sqrt(x);
}

/// 1/x for normal x, to 2 units in the last place.
SUTURE_INLINE double reciprocal(double x) { return 1 / x; }

template <int N>
SUTURE_INLINE pack<N> reciprocal(pack<N> x) {
#if defined(__AVX512F__)
  if constexpr (N == 8) {  // y (1 + e + e^2 + e^3), e = 1 - x y < 2^-14
    const pack<N> y = typename pack<N>::vector(_mm512_maskz_rcp14_pd(0xff, __m512d(x.v)));
    const pack<N> e = 1.0 - x * y;
    return y + y * e * (1.0 + e * (1.0 + e));
  }
#endif
  return 1.0 / x;
}

template <int N>
SUTURE_INLINE pack<N, float> reciprocal(pack<N, float> x) {
  return 1.0 / x;
}

/// Whether a type is a pack.
template <class T>
inline constexpr bool is_pack = false;
template <int N, class E>
inline constexpr bool is_pack<pack<N, E>> = true;

/// What a lane of T holds: double or float.
template <class T>
struct lane_type_of {
  using type = T;
};
template <int N, class E>
struct lane_type_of<pack<N, E>> {
  using type = E;
};
template <class T>
using lane_type = typename lane_type_of<T>::type;

/// Number of cells in a T.
template <class T>
inline constexpr int lanes_of = 1;
template <int N, class E>
inline constexpr int lanes_of<pack<N, E>> = N;

/// Reads a T at `p` (a number, or a pack that is aligned there), or writes it.
template <class T>
SUTURE_INLINE T load(const lane_type<T>* p) {
  if constexpr (is_pack<T>)
    return T::load(p);
  else
    return *p;
}
SUTURE_INLINE void store(double* p, double value) { *p = value; }
template <int N, class E>
SUTURE_INLINE void store(E* p, pack<N, E> value) {
  value.store(p);
}

/// One lane of a T, for messages and tests.
SUTURE_INLINE double lane(double value, int) { return value; }
template <int N, class E>
double lane(pack<N, E> value, int i) {
  return value[i];
}

}  // namespace suture

#endif
