// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Finds elements that may be stretched beyond a bound: the first stage of a tear check
// (operations/tear.hpp). Included by loops.cpp only; internal linkage throughout.

#include "kernel/forces/loops/lanes.hpp"
#include "kernel/forces/loops/loops.hpp"

namespace {

/// Eight lanes, in as many registers as the instruction set needs.
typedef double Lanes __attribute__((vector_size(64), aligned(64)));
typedef long long LaneMask __attribute__((vector_size(64)));

inline __attribute__((always_inline)) Lanes lanes_at(const double* p) {
  return *reinterpret_cast<const Lanes*>(p);
}

/// Sums of the four edge vectors along each axis, A[axis][component] x 4, by
/// differences and sums of pairs: 17 operations per component instead of 24.
inline __attribute__((always_inline)) void sum_edges(const double* x, Lanes A[3][3]) {
  for (uint32_t c = 0; c < 3; ++c) {
    const auto node = [&](uint32_t n) { return lanes_at(x + n * 24 + c * lanes); };
    const Lanes s0 = node(0) + node(1), s1 = node(2) + node(3), s2 = node(4) + node(5),
                s3 = node(6) + node(7);
    A[0][c] =
        ((node(1) - node(0)) + (node(3) - node(2))) + ((node(5) - node(4)) + (node(7) - node(6)));
    A[1][c] = (s1 - s0) + (s3 - s2);
    A[2][c] = (s2 + s3) - (s0 + s1);
  }
}

/// C = F^T F with F = sum_a A_a x G_a / 4 has an eigenvalue above `bound` only if
///   bound < q + 2 p,   q = tr C / 3,   p^2 = |C - q 1|^2 / 6
/// (Smith's formula, symmetric3.hpp, with the cosine at its maximum): no root is needed.
struct MayStrain {
  static constexpr uint32_t components = 9;
  static inline __attribute__((always_inline)) LaneMask test(const double* x, const double* g,
                                                             double bound) {
    Lanes A[3][3], C[3][3];
    sum_edges(x, A);
    Lanes F[3][3];
    for (uint32_t i = 0; i < 3; ++i)
      for (uint32_t j = 0; j < 3; ++j)
        F[i][j] = A[0][i] * lanes_at(g + j * lanes) + A[1][i] * lanes_at(g + (3 + j) * lanes) +
                  A[2][i] * lanes_at(g + (6 + j) * lanes);
    for (uint32_t i = 0; i < 3; ++i)
      for (uint32_t j = i; j < 3; ++j)
        C[i][j] = F[0][i] * F[0][j] + F[1][i] * F[1][j] + F[2][i] * F[2][j];
    const Lanes q = (C[0][0] + C[1][1] + C[2][2]) * (1.0 / 3);
    const Lanes a = C[0][0] - q, b = C[1][1] - q, c = C[2][2] - q;
    const Lanes off = C[0][1] * C[0][1] + C[0][2] * C[0][2] + C[1][2] * C[1][2];
    const Lanes square = (a * a + b * b + c * c + 2.0 * off) * (4.0 / 6);  // (2 p)^2
    const Lanes room = bound - q;
    return (room < 0.0) | (square > room * room);
  }
};

/// Some edge is longer than its limit; the metric holds the squared limits.
struct MayElongate {
  static constexpr uint32_t components = 12;
  static inline __attribute__((always_inline)) LaneMask test(const double* x, const double* limit,
                                                             double) {
    LaneMask found = {};
    for (uint32_t e = 0; e < 12; ++e) {
      const double* a = x + suture_hexahedron_edges[e][0] * 24;
      const double* b = x + suture_hexahedron_edges[e][1] * 24;
      Lanes length = {};
      for (uint32_t c = 0; c < 3; ++c) {
        const Lanes d = lanes_at(b + c * lanes) - lanes_at(a + c * lanes);
        length += d * d;
      }
      found |= length > lanes_at(limit + e * lanes);
    }
    return found;
  }
};

template <class Test, class C>
inline __attribute__((always_inline)) uint32_t stretched_lanes(const suture::loops::Stretch& job,
                                                               const C& cells, uint32_t row) {
  alignas(64) double x[192];
  for (uint32_t n = 0; n < 8; ++n) gather_node(job.position, cells, n, x + n * 24);
  const LaneMask found = Test::test(x, job.metric + row / lanes * job.block, job.bound);
  uint32_t bits = 0;
  for (uint32_t l = 0; l < lanes; ++l) bits |= (found[l] != 0 ? 1u : 0u) << l;
  return bits;
}

template <class Test>
uint32_t stretched(const suture::loops::Stretch* stretch, uint32_t begin, uint32_t end,
                   uint32_t* found) {
  const suture::loops::Stretch job = *stretch;
  uint32_t count = 0;
  for (uint32_t row = begin; row < end; row += lanes) {
    const uint32_t valid = end - row < lanes ? end - row : lanes;
    uint32_t bits;
    if (valid == lanes && !job.cells) {
      bits = stretched_lanes<Test>(job, Block<8>{job.nodes + static_cast<uint64_t>(row) * 8}, row);
    } else {
      Cells<8> cells;
      for (uint32_t l = 0; l < lanes; ++l) {
        const uint32_t r = row + (l < valid ? l : valid - 1);
        cells.nodes[l] = job.nodes + static_cast<uint64_t>(job.cells ? job.cells[r] : r) * 8;
      }
      bits = stretched_lanes<Test>(job, cells, row) & ((1u << valid) - 1);
    }
    for (; bits != 0; bits &= bits - 1)
      found[count++] = row + static_cast<uint32_t>(__builtin_ctz(bits));
  }
  return count;
}

}  // namespace
