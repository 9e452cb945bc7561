// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The passes of an integrator over rows of vertices: kicks and drifts. Included by loops.cpp only;
// internal linkage throughout.

#include "kernel/forces/loops/lanes.hpp"
#include "kernel/forces/loops/loops.hpp"

namespace {

using namespace suture::loops;

/// Number of rows by which a pass prefetches: with three columns written, the
/// processor's own prefetcher left a third of the time waiting (9.5 -> 6 ns per vertex on the
/// 60 x 60 x 120 grid).
constexpr uint32_t prefetch_distance = 24;

typedef double Row __attribute__((vector_size(32), aligned(32)));
/// Two rows side by side: a register of AVX-512, two of AVX2.
typedef double TwoRows __attribute__((vector_size(64), aligned(32)));
typedef double Eight __attribute__((vector_size(64), aligned(8)));
typedef int64_t Places __attribute__((vector_size(64)));

template <class V = Row>
inline V load(const double* p) {
  return *reinterpret_cast<const V*>(p);
}
template <class V>
inline void store(double* p, V v) {
  *reinterpret_cast<V*>(p) = v;
}

/// Sums of a pass, lane by lane; `zero` stays zero unless a velocity is infinite or no number.
struct RowSums {
  Row zero, before, after, inertia;
};

// The rows that fill a register, and the sums of a block: of every fourth row, to break the chain
// of additions. Without AVX-512, two rows together would take twice the instructions of one each.
#if defined(__AVX512F__)
typedef TwoRows Register;
struct RegisterSums {
  TwoRows zero, before, after, inertia;
};
#else
typedef Row Register;
typedef RowSums RegisterSums;
#endif
constexpr int64_t rows_at_once = sizeof(Register) / sizeof(Row);
typedef RegisterSums BlockSums[4 / rows_at_once];

/// Moves the vertices of a row or two.
template <int Kicks, bool Drift, class V, class S>
inline __attribute__((always_inline)) void move(const Motion& m, uint64_t at, V inverse, V mass,
                                                V gravity, S& sums) {
  const V a = load<V>(m.force + at) * inverse + gravity;
  const V before = load<V>(m.velocity + at);
  V v = before * m.decay[0] + a * m.gain[0];
  if (Kicks == 2) v = v * m.decay[1] + a * m.gain[1];
  const V momentum = v * mass;
  sums.zero += v * 0.0;
  sums.before += a * before * mass;
  sums.after += a * momentum;
  sums.inertia += v * momentum;
  store(m.velocity + at, v);
  if (Drift) {
    store(m.position + at, load<V>(m.position + at) + v * m.drift);
    store(m.force + at, V{});
  }
}

/// A block that is not whole, or of which only some vertices live.
template <int Kicks, bool Drift>
void move_some(const Motion& m, uint32_t first, uint32_t count, Row gravity, RowSums& sums) {
  for (uint32_t l = 0; l < count; ++l)
    if (!m.live || (m.live[first / lanes] >> l & 1) != 0)
      move<Kicks, Drift>(m, static_cast<uint64_t>(first + l) * 4, Row{} + 1.0 / m.mass[first + l],
                         Row{} + m.mass[first + l], gravity, sums);
}

/// Value l in every component of a row, and the next ones in those of further rows. clang, of the
/// sanitizers, has no shuffle by a variable.
inline __attribute__((always_inline)) Register spread(const Eight& values, int64_t l) {
#if !defined(__AVX512F__)
  return Row{values[l], values[l], values[l], values[l]};
#elif defined(__clang__)
  TwoRows result{};
  for (int i = 0; i < 8; ++i) result[i] = values[l + i / 4];
  return result;
#else
  return __builtin_shuffle(values, Places{l, l, l, l, l + 1, l + 1, l + 1, l + 1});
#endif
}

/// A whole block; masses are inverted together (a division per vertex would cost as much as the
/// rest).
template <int Kicks, bool Drift>
inline void move_block(const Motion& m, uint32_t first, Register gravity, BlockSums& sums) {
  const uint64_t at = static_cast<uint64_t>(first) * 4;
  for (uint32_t l = 0; l < lanes; l += 2) {
    const uint64_t ahead = at + (l + prefetch_distance) * 4;
    __builtin_prefetch(m.force + ahead, 1);
    __builtin_prefetch(m.velocity + ahead, 1);
    __builtin_prefetch(m.position + ahead, 1);
  }
  const Eight masses = load<Eight>(m.mass + first), inverses = 1.0 / masses;
#pragma GCC unroll 8
  for (int64_t l = 0; l < lanes; l += rows_at_once)
    move<Kicks, Drift>(m, at + static_cast<uint64_t>(l) * 4, spread(inverses, l), spread(masses, l),
                       gravity, sums[l % 4 / rows_at_once]);
}

inline double sum3(Row r) { return r[0] + r[1] + r[2]; }

/// The sums of every fourth row, and of single rows: the same order for every register.
inline Row fold(const BlockSums& sums, Register RegisterSums::*which, Row single) {
#if defined(__AVX512F__)
  const TwoRows both = sums[0].*which + sums[1].*which;
  return single + Row{both[0] + both[4], both[1] + both[5], both[2] + both[6], 0};
#else
  return single + ((sums[0].*which + sums[2].*which) + (sums[1].*which + sums[3].*which));
#endif
}

template <int Kicks, bool Drift>
int32_t pass(const Motion* motion, uint32_t begin, uint32_t end, PassSums* result) {
  const Motion m = *motion;
  const double* const g = m.gravity;
  const Row gravity = {g[0], g[1], g[2], 0};
#if defined(__AVX512F__)
  const TwoRows gravities = {g[0], g[1], g[2], 0, g[0], g[1], g[2], 0};
#else
  const Row gravities = gravity;
#endif
  RowSums single = {};
  BlockSums sums = {};
  for (uint32_t first = begin; first < end; first += lanes) {
    if (end - first >= lanes && (!m.live || m.live[first / lanes] == 0xFF))
      move_block<Kicks, Drift>(m, first, gravities, sums);
    else
      move_some<Kicks, Drift>(m, first, end - first < lanes ? end - first : lanes, gravity, single);
  }
  result->before = sum3(fold(sums, &RegisterSums::before, single.before));
  result->after = sum3(fold(sums, &RegisterSums::after, single.after));
  result->inertia = sum3(fold(sums, &RegisterSums::inertia, single.inertia));
  const Row zero = fold(sums, &RegisterSums::zero, single.zero);
  return zero[0] == 0 && zero[1] == 0 && zero[2] == 0 ? 0 : 1;
}

}  // namespace
