// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/vec3.hpp"

namespace suture {

/// A vector of a row of four.
inline Vec3 row(const double* rows, Index i) {
  const double* r = rows + 4 * std::size_t{i};
  return {r[0], r[1], r[2]};
}
inline void add_to_row(double* rows, Index i, const Vec3& a) {
  for (std::size_t c = 0; c < 3; ++c) rows[4 * std::size_t{i} + c] += a[c];
}

}  // namespace suture
