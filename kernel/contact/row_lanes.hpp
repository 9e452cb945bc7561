// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/types.hpp"

/// Inlined also into clones for other instruction sets (solvers/clones.hpp).
#define SUTURE_INLINE inline __attribute__((always_inline))

namespace suture {

/// A row of four doubles in a register, or four lanes of anything.
typedef double RowLanes __attribute__((vector_size(32), aligned(8), may_alias));

SUTURE_INLINE RowLanes& row_at(double* rows, std::size_t i) {
  return *reinterpret_cast<RowLanes*>(rows + 4 * i);
}
SUTURE_INLINE const RowLanes& row_at(const double* rows, std::size_t i) {
  return *reinterpret_cast<const RowLanes*>(rows + 4 * i);
}
SUTURE_INLINE RowLanes lanes_of(const Vec3& a) { return RowLanes{a[0], a[1], a[2], 0}; }
SUTURE_INLINE Vec3 vec_of(const RowLanes& a) { return {a[0], a[1], a[2]}; }
/// The product of the first three.
SUTURE_INLINE double dot(const RowLanes& a, const RowLanes& b) {
  const RowLanes product = a * b;
  return product[0] + product[1] + product[2];
}

}  // namespace suture
