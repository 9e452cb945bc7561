// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Rows of 4 doubles <-> 3 components x 8 lanes: the transposes of gather and
// scatter, for AVX-512, AVX2 and anything. 8 aligned row loads and a transpose
// in registers beat vgatherdpd (24 gathered words, one micro-operation each).
// Internal linkage throughout: see loops.hpp.

#include <stdint.h>
#if defined(__AVX__)
#include <immintrin.h>
#endif

namespace {

constexpr uint32_t lanes = 8;

/// Address of the row of node `n` of the cell in lane `l`.
template <class T>
inline __attribute__((always_inline)) T* row_of(T* rows, const uint32_t* const* cell, uint32_t l,
                                                uint32_t n) {
  return rows + static_cast<uint64_t>(cell[l][n]) * 4;
}

#if defined(__AVX512F__)

inline __attribute__((always_inline)) __m512d two_rows(const double* low, const double* high) {
  return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_load_pd(low)), _mm256_load_pd(high), 1);
}

/// out[c*8 + l] = component c of the row of lane l.
inline __attribute__((always_inline)) void gather_node(const double* rows,
                                                       const uint32_t* const* cell, uint32_t n,
                                                       double* out) {
  const __m512d a = two_rows(row_of(rows, cell, 0, n), row_of(rows, cell, 2, n));
  const __m512d b = two_rows(row_of(rows, cell, 1, n), row_of(rows, cell, 3, n));
  const __m512d c = two_rows(row_of(rows, cell, 4, n), row_of(rows, cell, 6, n));
  const __m512d d = two_rows(row_of(rows, cell, 5, n), row_of(rows, cell, 7, n));
  const __m512d xz_low = _mm512_unpacklo_pd(a, b);  // x0 x1 | z0 z1 | x2 x3 | z2 z3
  const __m512d y_low = _mm512_unpackhi_pd(a, b);   // y0 y1 | w0 w1 | y2 y3 | w2 w3
  const __m512d xz_high = _mm512_unpacklo_pd(c, d);
  const __m512d y_high = _mm512_unpackhi_pd(c, d);
  _mm512_store_pd(out, _mm512_shuffle_f64x2(xz_low, xz_high, 0x88));
  _mm512_store_pd(out + 8, _mm512_shuffle_f64x2(y_low, y_high, 0x88));
  _mm512_store_pd(out + 16, _mm512_shuffle_f64x2(xz_low, xz_high, 0xDD));
}

inline __attribute__((always_inline)) void add_row(double* row, __m256d value) {
  _mm256_store_pd(row, _mm256_add_pd(_mm256_load_pd(row), value));
}

/// Row of lane l += (in[l], in[8 + l], in[16 + l]), lanes in order: lanes may
/// share a vertex.
inline __attribute__((always_inline)) void scatter_node(double* rows, const uint32_t* const* cell,
                                                        uint32_t n, uint32_t valid,
                                                        const double* in) {
  const __m512d x = _mm512_load_pd(in), y = _mm512_load_pd(in + 8), z = _mm512_load_pd(in + 16);
  const __m512d zero = _mm512_setzero_pd();
  const __m512d xy_even = _mm512_unpacklo_pd(x, y), xy_odd = _mm512_unpackhi_pd(x, y);
  const __m512d z_even = _mm512_unpacklo_pd(z, zero), z_odd = _mm512_unpackhi_pd(z, zero);
  const __m512i first = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11);
  const __m512i second = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
  const __m512d r02 = _mm512_permutex2var_pd(xy_even, first, z_even);
  const __m512d r13 = _mm512_permutex2var_pd(xy_odd, first, z_odd);
  const __m512d r46 = _mm512_permutex2var_pd(xy_even, second, z_even);
  const __m512d r57 = _mm512_permutex2var_pd(xy_odd, second, z_odd);
  const __m256d row[8] = {_mm512_castpd512_pd256(r02),    _mm512_castpd512_pd256(r13),
                          _mm512_extractf64x4_pd(r02, 1), _mm512_extractf64x4_pd(r13, 1),
                          _mm512_castpd512_pd256(r46),    _mm512_castpd512_pd256(r57),
                          _mm512_extractf64x4_pd(r46, 1), _mm512_extractf64x4_pd(r57, 1)};
  if (valid == lanes) {
    for (uint32_t l = 0; l < lanes; ++l) add_row(row_of(rows, cell, l, n), row[l]);
  } else {
    for (uint32_t l = 0; l < valid; ++l) add_row(row_of(rows, cell, l, n), row[l]);
  }
}

#elif defined(__AVX__)

/// Four lanes: halves of rows pair up so that two unpacks transpose them.
inline __attribute__((always_inline)) void gather_half(const double* r0, const double* r1,
                                                       const double* r2, const double* r3,
                                                       double* out) {
  const __m256d xy02 =
      _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_load_pd(r0)), _mm_load_pd(r2), 1);
  const __m256d xy13 =
      _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_load_pd(r1)), _mm_load_pd(r3), 1);
  const __m256d zw02 =
      _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_load_pd(r0 + 2)), _mm_load_pd(r2 + 2), 1);
  const __m256d zw13 =
      _mm256_insertf128_pd(_mm256_castpd128_pd256(_mm_load_pd(r1 + 2)), _mm_load_pd(r3 + 2), 1);
  _mm256_store_pd(out, _mm256_unpacklo_pd(xy02, xy13));
  _mm256_store_pd(out + 8, _mm256_unpackhi_pd(xy02, xy13));
  _mm256_store_pd(out + 16, _mm256_unpacklo_pd(zw02, zw13));
}

inline __attribute__((always_inline)) void gather_node(const double* rows,
                                                       const uint32_t* const* cell, uint32_t n,
                                                       double* out) {
  gather_half(row_of(rows, cell, 0, n), row_of(rows, cell, 1, n), row_of(rows, cell, 2, n),
              row_of(rows, cell, 3, n), out);
  gather_half(row_of(rows, cell, 4, n), row_of(rows, cell, 5, n), row_of(rows, cell, 6, n),
              row_of(rows, cell, 7, n), out + 4);
}

inline __attribute__((always_inline)) void add_row(double* row, __m256d value) {
  _mm256_store_pd(row, _mm256_add_pd(_mm256_load_pd(row), value));
}

inline __attribute__((always_inline)) void rows_of_half(const double* in, __m256d* row) {
  const __m256d x = _mm256_load_pd(in), y = _mm256_load_pd(in + 8), z = _mm256_load_pd(in + 16);
  const __m256d zero = _mm256_setzero_pd();
  const __m256d xy_even = _mm256_unpacklo_pd(x, y), xy_odd = _mm256_unpackhi_pd(x, y);
  const __m256d z_even = _mm256_unpacklo_pd(z, zero), z_odd = _mm256_unpackhi_pd(z, zero);
  row[0] = _mm256_permute2f128_pd(xy_even, z_even, 0x20);
  row[1] = _mm256_permute2f128_pd(xy_odd, z_odd, 0x20);
  row[2] = _mm256_permute2f128_pd(xy_even, z_even, 0x31);
  row[3] = _mm256_permute2f128_pd(xy_odd, z_odd, 0x31);
}

inline __attribute__((always_inline)) void scatter_node(double* rows, const uint32_t* const* cell,
                                                        uint32_t n, uint32_t valid,
                                                        const double* in) {
  __m256d row[8];
  rows_of_half(in, row);
  rows_of_half(in + 4, row + 4);
  if (valid == lanes) {
    for (uint32_t l = 0; l < lanes; ++l) add_row(row_of(rows, cell, l, n), row[l]);
  } else {
    for (uint32_t l = 0; l < valid; ++l) add_row(row_of(rows, cell, l, n), row[l]);
  }
}

#else

inline void gather_node(const double* rows, const uint32_t* const* cell, uint32_t n, double* out) {
  for (uint32_t l = 0; l < lanes; ++l) {
    const double* row = row_of(rows, cell, l, n);
    for (uint32_t c = 0; c < 3; ++c) out[c * lanes + l] = row[c];
  }
}

inline void scatter_node(double* rows, const uint32_t* const* cell, uint32_t n, uint32_t valid,
                         const double* in) {
  for (uint32_t l = 0; l < valid; ++l) {
    double* row = row_of(rows, cell, l, n);
    for (uint32_t c = 0; c < 3; ++c) row[c] += in[c * lanes + l];
  }
}

#endif

}  // namespace
