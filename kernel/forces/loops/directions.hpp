// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Vectors of solvers <-> 3 components x 8 lanes: rows of 3 doubles, and rows of 4 floats, aligned,
// the fourth 0. Internal linkage throughout: see loops.hpp.

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "kernel/forces/loops/lanes.hpp"

namespace {

/// Address of the row of node `n` of the cell in lane `l`.
template <class C>
inline __attribute__((always_inline)) double* vector_row(double* rows, const C& cells, uint32_t l,
                                                         uint32_t n) {
  return rows + static_cast<uint64_t>(cells.vertex(l, n)) * 3;
}
template <class C>
inline __attribute__((always_inline)) const double* vector_row(const double* rows, const C& cells,
                                                               uint32_t l, uint32_t n) {
  return rows + static_cast<uint64_t>(cells.vertex(l, n)) * 3;
}
template <class T, class C>
inline __attribute__((always_inline)) T* vector_row(T* rows, const C& cells, uint32_t l,
                                                    uint32_t n) {
  return row_of(rows, cells, l, n);
}

#if defined(__AVX512F__)

/// A row and a fourth value that is not used; nothing behind the row is read.
inline __attribute__((always_inline)) __m256d load_vector_row(const double* row) {
  return _mm256_maskz_loadu_pd(7, row);
}
inline __attribute__((always_inline)) __m256d load_vector_row(const float* row) {
  return _mm256_cvtps_pd(_mm_load_ps(row));
}

/// out[c*8 + l] = component c of the row of lane l.
template <class Real, class C>
inline __attribute__((always_inline)) void gather_direction(const Real* rows, const C& cells,
                                                            uint32_t n, double* out) {
  const auto row = [&](uint32_t l) __attribute__((always_inline)) {
    return load_vector_row(vector_row(rows, cells, l, n));
  };
  const auto two = [&](uint32_t low, uint32_t high) __attribute__((always_inline)) {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(row(low)), row(high), 1);
  };
  store_transposed(two(0, 2), two(1, 3), two(4, 6), two(5, 7), out);
}

#else

template <class Real, class C>
inline __attribute__((always_inline)) void gather_direction(const Real* rows, const C& cells,
                                                            uint32_t n, double* out) {
  for (uint32_t l = 0; l < lanes; ++l) {
    const Real* const row = vector_row(rows, cells, l, n);
    for (uint32_t c = 0; c < 3; ++c) out[c * lanes + l] = static_cast<double>(row[c]);
  }
}

#endif

typedef double TwoDoubles __attribute__((vector_size(16), aligned(8), may_alias));
typedef float FourFloats __attribute__((vector_size(16), may_alias));

/// row += (in[l], in[8 + l], in[16 + l]): two operations on memory instead of three, or one.
inline __attribute__((always_inline)) void add_to_vector(double* row, const double* in,
                                                         uint32_t l) {
  *reinterpret_cast<TwoDoubles*>(row) += TwoDoubles{in[l], in[lanes + l]};
  row[2] += in[2 * lanes + l];
}
inline __attribute__((always_inline)) void add_to_vector(float* row, const double* in, uint32_t l) {
#if defined(__AVX__)
  const __m128d xy = _mm_loadh_pd(_mm_load_sd(in + l), in + lanes + l);
  const __m256d xyz =
      _mm256_insertf128_pd(_mm256_castpd128_pd256(xy), _mm_load_sd(in + 2 * lanes + l), 1);
  *reinterpret_cast<FourFloats*>(row) += _mm256_cvtpd_ps(xyz);
#else
  *reinterpret_cast<FourFloats*>(row) +=
      FourFloats{static_cast<float>(in[l]), static_cast<float>(in[lanes + l]),
                 static_cast<float>(in[2 * lanes + l]), 0};
#endif
}

/// Lanes are processed in order, each read after the previous write: they may share a vertex.
template <class Real, class C>
inline __attribute__((always_inline)) void scatter_direction(Real* rows, const C& cells, uint32_t n,
                                                             uint32_t valid, const double* in) {
  for (uint32_t l = 0; l < lanes; ++l) {
    if (l >= valid) return;
    add_to_vector(vector_row(rows, cells, l, n), in, l);
  }
}

// Rows of floats <-> 3 components x 16 lanes, of which 8 at a time.

#if defined(__AVX__)

/// The rows of lanes l and l + 4.
template <class C>
inline __attribute__((always_inline)) __m256 two_single_rows(const float* rows, const C& cells,
                                                             uint32_t n, uint32_t l) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(row_of(rows, cells, l, n))),
                              _mm_load_ps(row_of(rows, cells, l + 4, n)), 1);
}

/// out[c*16 + l] = component c of the row of lane l, times `scale`.
template <class C>
inline __attribute__((always_inline)) void gather_single_direction(const float* rows,
                                                                   const C& cells, uint32_t n,
                                                                   float scale, float* out) {
  const __m256 factor = _mm256_set1_ps(scale);
  const __m256 a = two_single_rows(rows, cells, n, 0), b = two_single_rows(rows, cells, n, 1),
               c = two_single_rows(rows, cells, n, 2), d = two_single_rows(rows, cells, n, 3);
  const __m256 xy_ab = _mm256_unpacklo_ps(a, b), xy_cd = _mm256_unpacklo_ps(c, d);
  const __m256 z_ab = _mm256_unpackhi_ps(a, b), z_cd = _mm256_unpackhi_ps(c, d);
  _mm256_store_ps(out, factor * _mm256_shuffle_ps(xy_ab, xy_cd, 0x44));
  _mm256_store_ps(out + 16, factor * _mm256_shuffle_ps(xy_ab, xy_cd, 0xEE));
  _mm256_store_ps(out + 32, factor * _mm256_shuffle_ps(z_ab, z_cd, 0x44));
}

inline __attribute__((always_inline)) void add_single_row(float* row, __m128 value) {
  _mm_store_ps(row, _mm_add_ps(_mm_load_ps(row), value));
}

/// The same in the other direction: rows of 8 lanes are added to those of the cells.
template <class C>
inline __attribute__((always_inline)) void scatter_whole(float* rows, const C& cells, uint32_t n,
                                                         const float* in) {
  const __m256 x = _mm256_load_ps(in), y = _mm256_load_ps(in + 16), z = _mm256_load_ps(in + 32);
  const __m256 zero = _mm256_setzero_ps();
  const __m256 xy_low = _mm256_unpacklo_ps(x, y), xy_high = _mm256_unpackhi_ps(x, y);
  const __m256 z_low = _mm256_unpacklo_ps(z, zero), z_high = _mm256_unpackhi_ps(z, zero);
  const __m256 two[4] = {
      _mm256_shuffle_ps(xy_low, z_low, 0x44), _mm256_shuffle_ps(xy_low, z_low, 0xEE),
      _mm256_shuffle_ps(xy_high, z_high, 0x44), _mm256_shuffle_ps(xy_high, z_high, 0xEE)};
  for (uint32_t l = 0; l < 4; ++l)
    add_single_row(row_of(rows, cells, l, n), _mm256_castps256_ps128(two[l]));
  for (uint32_t l = 0; l < 4; ++l)
    add_single_row(row_of(rows, cells, l + 4, n), _mm256_extractf128_ps(two[l], 1));
}

#else

template <class C>
inline void gather_single_direction(const float* rows, const C& cells, uint32_t n, float scale,
                                    float* out) {
  for (uint32_t l = 0; l < lanes; ++l)
    for (uint32_t c = 0; c < 3; ++c) out[c * 16 + l] = scale * row_of(rows, cells, l, n)[c];
}

template <class C>
inline void scatter_whole(float* rows, const C& cells, uint32_t n, const float* in) {
  for (uint32_t l = 0; l < lanes; ++l)
    *reinterpret_cast<FourFloats*>(row_of(rows, cells, l, n)) +=
        FourFloats{in[l], in[16 + l], in[32 + l], 0};
}

#endif

template <class C>
inline __attribute__((always_inline)) void scatter_single_direction(float* rows, const C& cells,
                                                                    uint32_t n, uint32_t valid,
                                                                    const float* in) {
  if (valid == lanes) return scatter_whole(rows, cells, n, in);
  for (uint32_t l = 0; l < valid; ++l)
    *reinterpret_cast<FourFloats*>(row_of(rows, cells, l, n)) +=
        FourFloats{in[l], in[16 + l], in[32 + l], 0};
}

}  // namespace
