// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "kernel/base/aligned.hpp"

namespace suture {

/// Vectors of a level in single precision: rows of 4 numbers per node, the fourth 0.
using SingleVector = AlignedVector<float>;
inline SingleVector single_vector(std::size_t nodes) { return SingleVector(nodes * 4); }

typedef float SingleRow __attribute__((vector_size(16), may_alias));
inline SingleRow* rows_of(SingleVector& v) { return reinterpret_cast<SingleRow*>(v.data()); }
inline const SingleRow* rows_of(const SingleVector& v) {
  return reinterpret_cast<const SingleRow*>(v.data());
}

/// Summed in double, in an order that depends on the size alone.
double dot(const SingleVector& a, const SingleVector& b);

/// `to` becomes a vector in rows of 3, divided by its largest magnitude, which is returned:
/// products of small or large forces would leave the range of floats.
double to_single(const double* from, SingleVector& to);
/// The reverse.
void to_double(const SingleVector& from, double scale, double* to);

/// y = A x, in rows of 4.
using SingleProduct = std::function<void(const float* x, float* y)>;

}  // namespace suture
