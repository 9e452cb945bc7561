// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "kernel/base/vec3.hpp"

namespace suture {

inline Vec3 plus(const Vec3& a, const Vec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vec3 scaled(double s, const Vec3& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline double norm(const Vec3& a) { return std::sqrt(dot(a, a)); }
/// A vector of a row of four.
inline Vec3 row(const double* rows, Index i) {
  const double* r = rows + 4 * std::size_t{i};
  return {r[0], r[1], r[2]};
}
inline void add_to_row(double* rows, Index i, const Vec3& a) {
  for (std::size_t c = 0; c < 3; ++c) rows[4 * std::size_t{i} + c] += a[c];
}

}  // namespace suture
