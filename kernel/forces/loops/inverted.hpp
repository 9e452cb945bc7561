// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Counts inverted elements. Included by loops.cpp only; internal linkage throughout.

#include "kernel/forces/loops/gather.hpp"

namespace {

using namespace suture::loops;

/// Triple product of the three edges that leave corner n along the axes, for all
/// lanes: the Jacobian there, positive for a right-handed corner.
inline void corner_jacobian(const double* x, uint32_t n, double* out) {
  const double* p = x + n * 24;
  const double* q[3];
  for (uint32_t a = 0; a < 3; ++a) q[a] = x + (n ^ (1u << a)) * 24;
  const double sign = (n & 1) ^ ((n >> 1) & 1) ^ ((n >> 2) & 1) ? -1.0 : 1.0;
  for (uint32_t l = 0; l < lanes; ++l) {
    double e[3][3];
    for (uint32_t a = 0; a < 3; ++a)
      for (uint32_t c = 0; c < 3; ++c) e[a][c] = q[a][c * lanes + l] - p[c * lanes + l];
    const double triple = e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
                          e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
                          e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
    const double jacobian = triple * sign;
    out[l] = out[l] < jacobian ? out[l] : jacobian;
  }
}

uint32_t inverted(const uint32_t* nodes, const uint8_t* live, const double* position,
                  uint32_t begin, uint32_t end, uint32_t* first) {
  Job job = {};
  job.nodes = nodes;
  alignas(64) double x[192];
  uint32_t found = 0;
  for (uint32_t row = begin; row < end;) {
    const uint32_t to_block = lanes - row % lanes;
    const uint32_t here = end - row < to_block ? end - row : to_block;
    const BatchRows rows = live_rows(live, row, here);
    row += here;
    if (rows.valid == 0) continue;
    gather_rows<8>(position, find_cells<8>(job, rows), x);
    double smallest[lanes];
    for (uint32_t l = 0; l < lanes; ++l) smallest[l] = __builtin_inf();
    for (uint32_t n = 0; n < 8; ++n) corner_jacobian(x, n, smallest);
    for (uint32_t l = 0; l < rows.valid; ++l) {
      if (smallest[l] > 0) continue;
      if (found == 0) *first = rows.row[l];
      ++found;
    }
  }
  return found;
}

}  // namespace
