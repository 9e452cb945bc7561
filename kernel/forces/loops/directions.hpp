// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Rows of 3 numbers, as vectors of solvers have them, <-> 3 components x 8 lanes. Internal linkage
// throughout: see loops.hpp.

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "kernel/forces/loops/lanes.hpp"

namespace {

/// Address of the row of node `n` of the cell in lane `l`.
template <class Real, class C>
inline __attribute__((always_inline)) Real* row3_of(Real* rows, const C& cells, uint32_t l,
                                                    uint32_t n) {
  return rows + static_cast<uint64_t>(cells.vertex(l, n)) * 3;
}

#if defined(__AVX512F__)

/// A row and a fourth value that is not used; nothing behind the row is read.
inline __attribute__((always_inline)) __m256d load_row3(const double* row) {
  return _mm256_maskz_loadu_pd(7, row);
}
inline __attribute__((always_inline)) __m256d load_row3(const float* row) {
  return _mm256_cvtps_pd(_mm_maskz_loadu_ps(7, row));
}

/// out[c*8 + l] = component c of the row of lane l.
template <class Real, class C>
inline __attribute__((always_inline)) void gather_node3(const Real* rows, const C& cells,
                                                        uint32_t n, double* out) {
  const auto row = [&](uint32_t l) __attribute__((always_inline)) {
    return load_row3(row3_of(rows, cells, l, n));
  };
  const auto two = [&](uint32_t low, uint32_t high) __attribute__((always_inline)) {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(row(low)), row(high), 1);
  };
  store_transposed(two(0, 2), two(1, 3), two(4, 6), two(5, 7), out);
}

#else

template <class Real, class C>
inline __attribute__((always_inline)) void gather_node3(const Real* rows, const C& cells,
                                                        uint32_t n, double* out) {
  for (uint32_t l = 0; l < lanes; ++l) {
    const Real* const row = row3_of(rows, cells, l, n);
    for (uint32_t c = 0; c < 3; ++c) out[c * lanes + l] = static_cast<double>(row[c]);
  }
}

#endif

template <class Real>
struct PairOf {
  typedef Real type
      __attribute__((vector_size(2 * sizeof(Real)), aligned(sizeof(Real)), may_alias));
};

/// Row of lane l += (in[l], in[8 + l], in[16 + l]): two operations on memory instead of three.
/// Lanes are processed in order, each read after the previous write: they may share a vertex.
template <class Real, class C>
inline __attribute__((always_inline)) void scatter_node3(Real* rows, const C& cells, uint32_t n,
                                                         uint32_t valid, const double* in) {
  using Pair = typename PairOf<Real>::type;
  for (uint32_t l = 0; l < lanes; ++l) {
    if (l >= valid) return;
    Real* const row = row3_of(rows, cells, l, n);
    *reinterpret_cast<Pair*>(row) +=
        Pair{static_cast<Real>(in[l]), static_cast<Real>(in[lanes + l])};
    row[2] += static_cast<Real>(in[2 * lanes + l]);
  }
}

#if defined(__SSE2__)

#if defined(__AVX512VL__)
inline __attribute__((always_inline)) __m128 load_single_row3(const float* row) {
  return _mm_maskz_loadu_ps(7, row);
}
#else
inline __attribute__((always_inline)) __m128 load_single_row3(const float* row) {
  const __m128 xy = _mm_castsi128_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(row)));
  return _mm_movelh_ps(xy, _mm_load_ss(row + 2));
}
#endif

/// out[c*16 + l] = component c of the row of lane l, times `scale`, four lanes at a time. What is
/// stored is not read in wider pieces soon after: the processor would have to wait.
template <class C>
inline __attribute__((always_inline)) void gather_single_node3(const float* rows, const C& cells,
                                                               uint32_t n, float scale,
                                                               float* out) {
  const __m128 factor = _mm_set1_ps(scale);
  for (uint32_t l = 0; l < lanes; l += 4) {
    const auto row = [&](uint32_t i) __attribute__((always_inline)) {
      return _mm_mul_ps(load_single_row3(row3_of(rows, cells, l + i, n)), factor);
    };
    const __m128 a = row(0), b = row(1), c = row(2), d = row(3);
    const __m128 xy_low = _mm_unpacklo_ps(a, b), xy_high = _mm_unpacklo_ps(c, d);
    _mm_store_ps(out + l, _mm_movelh_ps(xy_low, xy_high));
    _mm_store_ps(out + 16 + l, _mm_movehl_ps(xy_high, xy_low));
    _mm_store_ps(out + 32 + l, _mm_movelh_ps(_mm_unpackhi_ps(a, b), _mm_unpackhi_ps(c, d)));
  }
}

#else

template <class C>
inline void gather_single_node3(const float* rows, const C& cells, uint32_t n, float scale,
                                float* out) {
  for (uint32_t l = 0; l < lanes; ++l)
    for (uint32_t c = 0; c < 3; ++c) out[c * 16 + l] = scale * row3_of(rows, cells, l, n)[c];
}

#endif

/// As scatter_node3(), from rows of 16 lanes.
template <class C>
inline __attribute__((always_inline)) void scatter_single_node3(float* rows, const C& cells,
                                                                uint32_t n, uint32_t valid,
                                                                const float* in) {
  for (uint32_t l = 0; l < valid; ++l) {
    float* const row = row3_of(rows, cells, l, n);
    for (uint32_t c = 0; c < 3; ++c) row[c] += in[c * 16 + l];
  }
}

}  // namespace
