// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Rows of 4 doubles <-> 3 components x 8 lanes: the transposes of gather and scatter, for AVX-512,
// AVX2 and generic code. 8 aligned row loads and a transpose in registers beat vgatherdpd (24
// gathered words, one micro-operation each). Internal linkage throughout: see loops.hpp.

#include <stdint.h>
#if defined(__AVX__)
#include <immintrin.h>
#endif

namespace {

enum : uint32_t { lanes = 8 };

/// Eight cells of N nodes at arbitrary addresses.
template <uint32_t N>
struct Cells {
  const uint32_t* nodes[lanes];
  uint32_t vertex(uint32_t l, uint32_t n) const { return nodes[l][n]; }
};

/// Eight consecutive cells of N nodes, which most batches are.
template <uint32_t N>
struct Block {
  const uint32_t* nodes;
  uint32_t vertex(uint32_t l, uint32_t n) const { return nodes[l * N + n]; }
};

/// Address of the row of node `n` of the cell in lane `l`.
template <class T, class C>
inline __attribute__((always_inline)) T* row_of(T* rows, const C& cells, uint32_t l, uint32_t n) {
  return rows + static_cast<uint64_t>(cells.vertex(l, n)) * 4;
}

#if defined(__AVX512F__)

inline __attribute__((always_inline)) __m512d two_rows(const double* low, const double* high) {
  return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_load_pd(low)), _mm256_load_pd(high), 1);
}

/// Rows of lanes 0 and 2, 1 and 3, 4 and 6, 5 and 7 -> out[c*8 + l].
inline __attribute__((always_inline)) void store_transposed(__m512d a, __m512d b, __m512d c,
                                                            __m512d d, double* out) {
  const __m512d xz_low = _mm512_unpacklo_pd(a, b);  // x0 x1 | z0 z1 | x2 x3 | z2 z3
  const __m512d y_low = _mm512_unpackhi_pd(a, b);   // y0 y1 | w0 w1 | y2 y3 | w2 w3
  const __m512d xz_high = _mm512_unpacklo_pd(c, d);
  const __m512d y_high = _mm512_unpackhi_pd(c, d);
  _mm512_store_pd(out, _mm512_shuffle_f64x2(xz_low, xz_high, 0x88));
  _mm512_store_pd(out + 8, _mm512_shuffle_f64x2(y_low, y_high, 0x88));
  _mm512_store_pd(out + 16, _mm512_shuffle_f64x2(xz_low, xz_high, 0xDD));
}

/// out[c*8 + l] = component c of the row of lane l.
template <class C>
inline __attribute__((always_inline)) void gather_node(const double* rows, const C& cell,
                                                       uint32_t n, double* out) {
  store_transposed(two_rows(row_of(rows, cell, 0, n), row_of(rows, cell, 2, n)),
                   two_rows(row_of(rows, cell, 1, n), row_of(rows, cell, 3, n)),
                   two_rows(row_of(rows, cell, 4, n), row_of(rows, cell, 6, n)),
                   two_rows(row_of(rows, cell, 5, n), row_of(rows, cell, 7, n)), out);
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

template <class C>
inline __attribute__((always_inline)) void gather_node(const double* rows, const C& cell,
                                                       uint32_t n, double* out) {
  gather_half(row_of(rows, cell, 0, n), row_of(rows, cell, 1, n), row_of(rows, cell, 2, n),
              row_of(rows, cell, 3, n), out);
  gather_half(row_of(rows, cell, 4, n), row_of(rows, cell, 5, n), row_of(rows, cell, 6, n),
              row_of(rows, cell, 7, n), out + 4);
}

#endif

#if defined(__AVX__)

/// Row of lane l += (in[l], in[8 + l], in[16 + l], 0). Built from 128-bit halves
/// with loads that broadcast: an unpack and a blend per row, which three ports
/// share, where a transpose of 512-bit registers would queue at one.
inline __attribute__((always_inline)) void add_to_row(double* row, const double* in, __m128d xy,
                                                      uint32_t l) {
  const __m256d z = _mm256_broadcast_sd(in + 16 + l);
  const __m256d value = _mm256_blend_pd(_mm256_zextpd128_pd256(xy), z, 4);
  _mm256_store_pd(row, _mm256_add_pd(_mm256_load_pd(row), value));
}

/// Lanes are processed in order, each read after the previous write: they may share a vertex.
template <class C>
inline __attribute__((always_inline)) void scatter_node(double* rows, const C& cell, uint32_t n,
                                                        uint32_t valid, const double* in) {
  for (uint32_t l = 0; l < lanes; l += 2) {
    const __m128d x = _mm_load_pd(in + l), y = _mm_load_pd(in + 8 + l);
    if (l < valid) add_to_row(row_of(rows, cell, l, n), in, _mm_unpacklo_pd(x, y), l);
    if (l + 1 < valid) add_to_row(row_of(rows, cell, l + 1, n), in, _mm_unpackhi_pd(x, y), l + 1);
  }
}

#else

template <class C>
inline void gather_node(const double* rows, const C& cell, uint32_t n, double* out) {
  for (uint32_t l = 0; l < lanes; ++l) {
    const double* row = row_of(rows, cell, l, n);
    for (uint32_t c = 0; c < 3; ++c) out[c * lanes + l] = row[c];
  }
}

template <class C>
inline void scatter_node(double* rows, const C& cell, uint32_t n, uint32_t valid,
                         const double* in) {
  for (uint32_t l = 0; l < valid; ++l) {
    double* row = row_of(rows, cell, l, n);
    for (uint32_t c = 0; c < 3; ++c) row[c] += in[c * lanes + l];
  }
}

#endif

}  // namespace
