// SPDX-License-Identifier: MIT
//
// suture/elementary.hpp - exp, expm1, log, log1p, pow, sin, cos, tanh and cbrt of packs.
//
// Every lane has the result of its own argument alone: at most 2 units in the last place from
// the exact one, for every argument. What a double gives as a special value (zeros,
// infinities, NaN, arguments out of the domain), a lane gives, too. Largest errors measured
// in doubles: log 0.8, sin and cos 0.9, cbrt 1.0, exp 1.1, pow and expm1 1.3, log1p and tanh 1.4.
//
// Each function reduces its argument to a short interval and evaluates a polynomial that
// was fitted there (Chebyshev interpolation in 50 digits). The reductions are those of
// Muller et al., Handbook of Floating-Point Arithmetic, 2nd edition, 2018, chapter 10.
// exp, expm1, log and log1p of floats are evaluated in floats, all others in doubles. Rare
// arguments (pow of x <= 0, angles beyond 10^6) are left to the C library, lane by lane.
#ifndef SUTURE_ELEMENTARY_HPP
#define SUTURE_ELEMENTARY_HPP

#include "suture/simd.hpp"

namespace suture {

namespace detail {

/// Layout and limits of an element type, and what depends on its precision.
template <class E>
struct ieee;
template <>
struct ieee<double> {
  using bits = std::uint64_t;
  static constexpr int mantissa = 52;
  static constexpr bits bias = 1023, root_half = 0x3fe6a09e00000000;  // a number near sqrt(1/2)
  static constexpr double to_integer = 0x1.8p52;  // added and subtracted again: rounds
  static constexpr double normal = 0x1p-1022, largest = 0x1.fffffffffffffp1023;
  static constexpr double lift = 0x1p54, lift_exponent = 54;  // makes subnormal numbers normal
  static constexpr double lowest_exponential = -746, highest_exponential = 710;
  /// ln 2 in two parts; multiples of the first by an exponent are exact.
  static constexpr double ln2[] = {0x1.62e42fefa3800p-1, 0x1.ef35793c76730p-45};
  /// (e^r - 1 - r) / r^2 for |r| < ln(2)/2
  static constexpr double exponential[] = {0.50000000000000010337,   0.16666666666666667462,
                                           0.041666666666623741555,  0.0083333333333300321239,
                                           0.0013888888917406445626, 0.00019841269863201828392,
                                           2.4801520996825695798e-5, 2.7557268229963225661e-6,
                                           2.7620230567506897885e-7, 2.5100494788905040481e-8};
  /// (2 artanh(s) - 2 s) / s^3 by s^2, for m = (1 + s) / (1 - s) between the roots of 1/2 and 2
  static constexpr double logarithm[] = {0.66666666666666696883, 0.39999999999899443233,
                                         0.28571428626003268742, 0.22222211130259877029,
                                         0.18182889455674946038, 0.15331710618210771569,
                                         0.14616585424888621974};
};
template <>
struct ieee<float> {
  using bits = std::uint32_t;
  static constexpr int mantissa = 23;
  static constexpr bits bias = 127, root_half = 0x3f3504f3;
  static constexpr double to_integer = 0x1.8p23;
  static constexpr double normal = 0x1p-126, largest = 0x1.fffffep127;
  static constexpr double lift = 0x1p25, lift_exponent = 25;
  static constexpr double lowest_exponential = -104, highest_exponential = 89;
  static constexpr double ln2[] = {0x1.62e4000000000p-1, 0x1.7f7d1cf79abcap-20};
  static constexpr double exponential[] = {0.5, 0.16666576583158001898, 0.04166655410934671658,
                                           0.0083632466697537282587, 0.0013926268052570573462};
  static constexpr double logarithm[] = {0.66666685045156029067, 0.39988778282162807728,
                                         0.29580053043188442133};
};

template <int N, class E>
using unsigned_bits = vector_of<typename ieee<E>::bits, N>;
template <int N, class E>
SUTURE_INLINE unsigned_bits<N, E> bits_of(pack<N, E> x) {
  return unsigned_bits<N, E>(x.v);
}
template <int N, class E>
SUTURE_INLINE pack<N, E> from_bits(unsigned_bits<N, E> b) {
  return typename pack<N, E>::vector(b);
}

/// c[0] + c[1] x + ..., its even and its odd terms in two chains that do not wait for each other.
template <int C, class P>
SUTURE_INLINE P polynomial(P x, const double (&c)[C]) {
  const P square = x * x;
  P even = c[(C - 1) & ~1], odd = c[(C - 2) | 1];
#pragma GCC unroll 16
  for (int i = ((C - 1) & ~1) - 2; i >= 0; i -= 2) even = c[i] + square * even;
#pragma GCC unroll 16
  for (int i = ((C - 2) | 1) - 2; i >= 1; i -= 2) odd = c[i] + square * odd;
  return even + x * odd;
}

/// The nearest integer to x as k + to_integer: its low bits are those of k.
template <int N, class E>
SUTURE_INLINE pack<N, E> shifted_integer(pack<N, E> x) {
  return x + ieee<E>::to_integer;
}
/// 2^k from k + to_integer.
template <int N, class E>
SUTURE_INLINE pack<N, E> power_of_two(pack<N, E> shifted) {
  return from_bits<N, E>((bits_of(shifted) + ieee<E>::bias) << ieee<E>::mantissa);
}
/// a 2^k for an integer k, in two factors: the result may be subnormal.
template <int N, class E>
SUTURE_INLINE pack<N, E> scaled(pack<N, E> a, pack<N, E> k) {
  const pack<N, E> half = shifted_integer(0.5 * k);
  const pack<N, E> rest = shifted_integer(k - (half - ieee<E>::to_integer));
  return a * power_of_two(half) * power_of_two(rest);
}

/// e^(x + tail), |tail| much smaller than one.
template <int N, class E>
SUTURE_INLINE pack<N, E> exponential(pack<N, E> x, pack<N, E> tail) {
  using P = pack<N, E>;
  using I = ieee<E>;
  const P inside = min(P(I::highest_exponential), max(P(I::lowest_exponential), x));  // keeps NaN
  const P k = shifted_integer(inside * 1.4426950408889634) - I::to_integer;
  const P r = ((inside - k * I::ln2[0]) - k * I::ln2[1]) + tail;
  return scaled(1.0 + (r + r * r * polynomial(r, I::exponential)), k);
}

/// x = 2^exponent m with m between the roots of 1/2 and 2, for finite x > 0.
template <class P>
struct decomposed {
  P m, exponent;
};
template <int N, class E>
SUTURE_INLINE decomposed<pack<N, E>> decompose(pack<N, E> x) {
  using P = pack<N, E>;
  using I = ieee<E>;
  using B = typename I::bits;
  const auto subnormal = x < I::normal;
  const auto b =
      bits_of(select(subnormal, x * I::lift, x)) + ((I::bias << I::mantissa) - I::root_half);
  const P biased = from_bits<N, E>((b >> I::mantissa) | bits_of(P(I::to_integer)));
  const P m = from_bits<N, E>((b & ((B(1) << I::mantissa) - 1)) + I::root_half);
  return {m, biased - (I::to_integer + double(I::bias)) -
                 select(subnormal, P(I::lift_exponent), P(0.0))};
}

/// Replaces the lanes of `result` in which `usual` does not hold by f(lane).
template <int N, class E, class F>
[[gnu::noinline, gnu::cold]] pack<N, E> with_rare_lanes(pack<N, E> result,
                                                        typename pack<N, E>::mask usual, F f) {
  for (int lane = 0; lane < N; ++lane)
    if (!usual[lane]) result.v[lane] = f(lane);
  return result;
}

/// f of floats, evaluated in doubles.
template <int N, class F>
SUTURE_INLINE pack<N, float> in_double(pack<N, float> x, F f) {
  using half = vector_of<float, N / 2>;
  half part[2];
  std::memcpy(part, &x.v, sizeof x.v);
  for (half& p : part)
    p = __builtin_convertvector(
        f(pack<N / 2>(__builtin_convertvector(p, vector_of<double, N / 2>))).v, half);
  std::memcpy(&x.v, part, sizeof x.v);
  return x;
}

}  // namespace detail

template <int N, class E>
SUTURE_INLINE pack<N, E> exp(pack<N, E> x) {
  return detail::exponential(x, pack<N, E>(0.0));
}

/// ln m = f - f^2/2 + s (f^2/2 + R), with f = m - 1, s = f / (2 + f), R = 2 artanh(s)/s - 2.
template <int N, class E>
SUTURE_INLINE pack<N, E> log(pack<N, E> x) {
  using P = pack<N, E>;
  using I = detail::ieee<E>;
  const auto [m, exponent] = detail::decompose(x);
  const P f = m - 1.0, s = f * reciprocal(2.0 + f), z = s * s, half_square = 0.5 * f * f;
  const P R = z * detail::polynomial(z, I::logarithm);
  const P low = s * (half_square + R) + exponent * I::ln2[1];
  const P regular = exponent * I::ln2[0] - ((half_square - low) - f);
  const P zero_or_less =
      select(x == 0.0, P(-HUGE_VAL), P(std::numeric_limits<double>::quiet_NaN()));
  // The sum gives the NaN of a NaN, and infinity.
  return select(x > 0.0, select(x <= I::largest, regular, x), select(x <= 0.0, zero_or_less, x));
}

/// ln(1 + x), with all digits where x is small: the log of the rounded sum, and what it lost.
template <int N, class E>
SUTURE_INLINE pack<N, E> log1p(pack<N, E> x) {
  using P = pack<N, E>;
  const P sum = 1.0 + x, part = sum - 1.0, lost = (1.0 - (sum - part)) + (x - part);
  const auto regular = (sum > 0.0) & (sum <= detail::ieee<E>::largest);
  return log(sum) + select(regular, lost * reciprocal(sum), P(0.0));
}

/// e^x - 1, with all digits where x is small: 2^k ((1 - 2^-k) + (e^r - 1)) for x = k ln 2 + r.
template <int N, class E>
SUTURE_INLINE pack<N, E> expm1(pack<N, E> x) {
  using P = pack<N, E>;
  using I = detail::ieee<E>;
  const P inside = min(P(I::highest_exponential), max(P(-40.0), x));  // keeps NaN
  const P k = detail::shifted_integer(inside * 1.4426950408889634) - I::to_integer;
  const P high = inside - k * I::ln2[0], low = k * I::ln2[1], r = high - low;
  const P other = 1.0 - detail::power_of_two(detail::shifted_integer(-min(k, P(60.0))));
  const P sum = other + r, lost = (r - (sum - other)) + ((high - r) - low);
  return detail::scaled(sum + (lost + r * r * detail::polynomial(r, I::exponential)), k);
}

/// Halley's iteration t + t (y - t^3) / (2 t^3 + y) from a polynomial good to 2^-19.
template <int N>
SUTURE_INLINE pack<N> cbrt(pack<N> x) {
  using P = pack<N>;
  constexpr double root[] = {0.47514693623890252999,   0.83174314424793097742,
                             -0.46029772676962090378,  0.1966547970136007771,
                             -0.048318320681661139681, 0.0050729533252774918054};
  const P size = abs(x);
  const auto [low, exponent] = detail::decompose(size);
  const auto below = low < 1.0;
  const P m = select(below, low + low, low);  // in [1, 2)
  const P e = select(below, exponent - 1.0, exponent);
  const P third = detail::shifted_integer(e * (1.0 / 3)) - detail::ieee<double>::to_integer;
  const P left = e - 3.0 * third;  // -1, 0 or 1
  const P y = select(left < 0.0, 0.5 * m, select(left > 0.0, 2.0 * m, m));
  const P factor = select(left < 0.0, P(0.79370052598409973738),
                          select(left > 0.0, P(1.2599210498948731648), P(1.0)));
  const P t = factor * detail::polynomial(m, root), cube = t * t * t;
  const P better = t + t * (y - cube) * reciprocal(cube + cube + y);
  const P signed_root =
      select(x < 0.0, -better, better) * detail::power_of_two(detail::shifted_integer(third));
  return select((size > 0.0) & (size <= detail::ieee<double>::largest), signed_root, x);
}
template <int N>
SUTURE_INLINE pack<N, float> cbrt(pack<N, float> x) {
  return detail::in_double(x, [](auto a) SUTURE_DETAIL_INLINED { return cbrt(a); });
}

/// Near zero x + x^3 Q(x^2), elsewhere 1 - 2 / (e^2x + 1).
template <int N>
SUTURE_INLINE pack<N> tanh(pack<N> x) {
  using P = pack<N>;
  constexpr double near_zero[] = {
      -0.33333333333333326242,   0.13333333333328754471,    -0.053968253963354356616,
      0.021869488331117609952,   -0.0088632311150306820588, 0.0035920723407851502126,
      -0.0014553936305847203261, 0.00058776554905116277653, -0.00023154597190158215694,
      8.0596326469283140629e-5,  -1.779207198628121305e-5};
  const P size = abs(x), z = x * x;
  const P far = 1.0 - 2.0 / (exp(size + size) + 1.0);
  return select(size < 0.6, x + x * z * detail::polynomial(z, near_zero),
                select(x < 0.0, -far, far));
}
template <int N>
SUTURE_INLINE pack<N, float> tanh(pack<N, float> x) {
  return detail::in_double(x, [](auto a) SUTURE_DETAIL_INLINED { return tanh(a); });
}

// -------------------------------------------------------------- sine, cosine --

namespace detail {

/// sin(x + quarters pi/2). The remainder of x is exact to 150 bits of pi/2: products of an
/// integer below 2^20 and the first three parts are exact.
template <int N, int Quarters>
SUTURE_INLINE pack<N> sine(pack<N> x) {
  using P = pack<N>;
  constexpr double sine_terms[] = {-0.16666666666666664622,    0.0083333333333309472945,
                                   -0.00019841269836756772528, 2.7557316101617874437e-6,
                                   -2.505113165023518147e-8,   1.5918115263265975195e-10};
  constexpr double cosine_terms[] = {0.041666666666666665388,  -0.0013888888888887396492,
                                     2.4801587298764560771e-5, -2.7557317271145145962e-7,
                                     2.0876146146558611582e-9, -1.138262364747460463e-11};
  const P shifted = shifted_integer(x * 0.63661977236758134308);
  const P k = shifted - ieee<double>::to_integer;
  P high = x - k * 0x1.921fb544p0, low(0.0);
  const auto subtract = [&](P part) SUTURE_DETAIL_INLINED {
    const P difference = high - part, back = difference - high;
    low += (high - (difference - back)) - (part + back);
    high = difference;
  };
  subtract(k * 0x1.0b4611a6p-34);
  subtract(k * 0x1.3198a2ep-69);
  low -= k * 0x1.b839a252049c1p-104;
  const P y = high + low, tail = (high - y) + low, z = y * y, half = 0.5 * z, rest = 1.0 - half;
  const P s = y + (y * z * polynomial(z, sine_terms) + tail * rest);
  const P c = rest + (((1.0 - rest) - half) + (z * z * polynomial(z, cosine_terms) - y * tail));
  const auto quadrant = bits_of(shifted) + std::uint64_t(Quarters);
  const P value = from_bits<N, double>((quadrant & 1) == 0 ? bits_of(s) : bits_of(c));
  return from_bits<N, double>(bits_of(value) ^ ((quadrant & 2) << 62));
}
inline constexpr double largest_angle = 1e6;

}  // namespace detail

template <int N>
SUTURE_INLINE pack<N> sin(pack<N> x) {
  const pack<N> usual = detail::sine<N, 0>(x);
  const auto small = abs(x) <= detail::largest_angle;
  if (__builtin_expect(all(small), 1)) return usual;
  return detail::with_rare_lanes(usual, small, [x](int lane) { return std::sin(x[lane]); });
}
template <int N>
SUTURE_INLINE pack<N> cos(pack<N> x) {
  const pack<N> usual = detail::sine<N, 1>(x);
  const auto small = abs(x) <= detail::largest_angle;
  if (__builtin_expect(all(small), 1)) return usual;
  return detail::with_rare_lanes(usual, small, [x](int lane) { return std::cos(x[lane]); });
}
template <int N>
SUTURE_INLINE pack<N, float> sin(pack<N, float> x) {
  return detail::in_double(x, [](auto a) SUTURE_DETAIL_INLINED { return sin(a); });
}
template <int N>
SUTURE_INLINE pack<N, float> cos(pack<N, float> x) {
  return detail::in_double(x, [](auto a) SUTURE_DETAIL_INLINED { return cos(a); });
}

// --------------------------------------------------------------------- power --

namespace detail {

/// high + low, |low| at most half a unit in the last place of high.
template <class P>
struct two_part {
  P high, low;
};
/// a + b, for |a| >= |b|.
template <class P>
SUTURE_INLINE two_part<P> exact_sum(P a, P b) {
  const P sum = a + b;
  return {sum, b - (sum - a)};
}

/// Whether a b + c with one rounding is an instruction for packs of this width.
template <int N>
inline constexpr bool has_fused =
#if defined(__AVX512F__)
    N == 8;
#elif defined(__FMA__)
    N == 4;
#else
    false;
#endif
template <int N>
SUTURE_INLINE pack<N> fused(pack<N> a, pack<N> b, pack<N> c) {
  using vector [[maybe_unused]] = typename pack<N>::vector;
#if defined(__AVX512F__)
  if constexpr (N == 8) return vector(_mm512_fmadd_pd(__m512d(a.v), __m512d(b.v), __m512d(c.v)));
#elif defined(__FMA__)
  if constexpr (N == 4) return vector(_mm256_fmadd_pd(__m256d(a.v), __m256d(b.v), __m256d(c.v)));
#endif
  return a * b + c;
}
template <int N>
SUTURE_INLINE two_part<pack<N>> exact_product(pack<N> a, pack<N> b) {
  const pack<N> high = a * b;
  return {high, fused(a, b, -high)};
}

/// ln x to about 68 bits: 2 s + s^3 (2/3 + s^2 q), in two parts up to the term with q.
template <int N>
SUTURE_INLINE two_part<pack<N>> precise_log(pack<N> x) {
  using P = pack<N>;
  constexpr double terms[] = {0.39999999999999999817, 0.28571428571429366235,
                              0.22222222221655885704, 0.18181818335392801628,
                              0.15384594962518431516, 0.13334804693847310304,
                              0.11706236339491206559, 0.11723178623876517281};
  const auto [m, exponent] = decompose(x);
  const P f = m - 1.0;
  const two_part<P> sum = exact_sum<P>(2.0, f);
  const P inverse = reciprocal(sum.high), s = f * inverse;
  const P rest = fused(-s, sum.high, f) - s * sum.low, s_low = rest * inverse;
  const two_part<P> z = exact_product(s, s);
  const P z_low = z.low + 2.0 * s * s_low;
  const two_part<P> c = exact_sum<P>(0x1.5555555555555p-1, z.high * polynomial(z.high, terms));
  const P c_low = c.low + 0x1.5555555555555p-55;
  const two_part<P> zc = exact_product(z.high, c.high);
  const P zc_low = zc.low + (z.high * c_low + z_low * c.high);
  const two_part<P> t = exact_product(s, zc.high);  // ln m = 2 s + t
  const P t_low = t.low + (s * zc_low + s_low * zc.high);
  const two_part<P> a = exact_sum(s + s, t.high);
  const P a_low = a.low + (t_low + 2.0 * s_low);
  const two_part<P> all = exact_sum(exponent * ieee<double>::ln2[0], a.high);
  return exact_sum(all.high, all.low + (a_low + exponent * ieee<double>::ln2[1]));
}

/// x^y for finite x > 0 and finite y.
template <int N>
SUTURE_INLINE pack<N> positive_power(pack<N> x, pack<N> y) {
  const two_part<pack<N>> l = precise_log(x), e = exact_product(y, l.high);
  const pack<N> low = e.low + y * l.low;
  return exponential(e.high, select(abs(e.high) < 800.0, low, pack<N>(0.0)));
}

/// `power` where x and y are as positive_power() needs them, elsewhere that of the C library.
template <int N>
SUTURE_INLINE pack<N> or_library_power(pack<N> power, pack<N> x, double y) {
  constexpr double largest = ieee<double>::largest;
  const auto usual = (x > 0.0) & (x <= largest) & (abs(pack<N>(y)) <= largest);
  if (__builtin_expect(all(usual), 1)) return power;
  return with_rare_lanes(power, usual, [=](int lane) { return std::pow(x[lane], y); });
}

}  // namespace detail

/// Without a fused multiply-add, the C library is as fast.
template <int N>
SUTURE_INLINE pack<N> pow(pack<N> x, double y) {
  if constexpr (detail::has_fused<N>)
    return detail::or_library_power(detail::positive_power(x, pack<N>(y)), x, y);
  else
    return pack<N>::map(x, [y](double a) { return std::pow(a, y); });
}
template <int N>
SUTURE_INLINE pack<N, float> pow(pack<N, float> x, double y) {
  return detail::in_double(x, [y](auto a) SUTURE_DETAIL_INLINED {
    return detail::or_library_power(exp(y * log(a)), a, y);
  });
}

// The same functions for one double.
using std::cbrt;
using std::cos;
using std::exp;
using std::expm1;
using std::log;
using std::log1p;
using std::pow;
using std::sin;
using std::tanh;

}  // namespace suture

#endif
