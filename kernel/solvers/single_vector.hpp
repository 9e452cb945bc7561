// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <numeric>
#include <vector>

#include "kernel/base/aligned.hpp"
#include "kernel/base/parallel.hpp"

namespace suture {

/// Vectors of a level in single precision: rows of 4 numbers per node, the fourth 0.
using SingleVector = AlignedVector<float>;
inline SingleVector single_vector(std::size_t nodes) { return SingleVector(nodes * 4); }

typedef float SingleRow __attribute__((vector_size(16), may_alias));
inline SingleRow* rows_of(SingleVector& v) { return reinterpret_cast<SingleRow*>(v.data()); }
inline const SingleRow* rows_of(const SingleVector& v) {
  return reinterpret_cast<const SingleRow*>(v.data());
}

/// Loops over vectors are shared among threads in chunks of this many rows, about 10 us of work. So
/// are sums: their order depends on the size alone.
inline constexpr std::size_t vector_chunk = 4096;

/// Calls visit(first, rows) for the chunks of a vector.
template <class Visit>
void for_vector_chunks(std::size_t rows, const Workers* workers, Visit&& visit) {
  for_chunks(rows, vector_chunk, workers,
             [&](std::size_t first, std::size_t end, std::size_t) { visit(first, end - first); });
}

/// The sum of sum_of(first, rows) over the chunks of a vector, in their order.
template <class Sum>
double sum_vector_chunks(std::size_t rows, const Workers* workers, Sum&& sum_of) {
  if (rows <= vector_chunk) return sum_of(std::size_t{0}, rows);
  std::vector<double> sums((rows + vector_chunk - 1) / vector_chunk);
  for_chunks(rows, vector_chunk, workers,
             [&](std::size_t first, std::size_t end, std::size_t chunk) {
               sums[chunk] = sum_of(first, end - first);
             });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

/// Summed in double.
double dot(const SingleVector& a, const SingleVector& b, const Workers* workers);

/// `to` becomes a vector in rows of 3, divided by its largest magnitude, which is returned:
/// products of small or large forces would leave the range of floats.
double to_single(const double* from, SingleVector& to, const Workers* workers);
/// The reverse.
void to_double(const SingleVector& from, double scale, double* to, const Workers* workers);

/// y = A x, in rows of 4.
using SingleProduct = std::function<void(const float* x, float* y)>;

}  // namespace suture
