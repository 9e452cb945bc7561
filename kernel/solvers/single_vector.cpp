// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/single_vector.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/solvers/clones.hpp"

namespace suture {
namespace {

typedef double Doubles __attribute__((vector_size(32), aligned(8), may_alias));

/// The largest magnitude, or 1 if all are as good as 0.
inline __attribute__((always_inline)) double largest(const double* values, std::size_t count) {
  Doubles most{};
  std::size_t i = 0;
  for (; i + 4 <= count; i += 4) {
    const Doubles four = *reinterpret_cast<const Doubles*>(values + i);
    most = four > most ? four : most;
    most = -four > most ? -four : most;
  }
  double result = 0;
  for (int c = 0; c < 4; ++c) result = std::max(result, most[c]);
  for (; i < count; ++i) result = std::max(result, std::abs(values[i]));
  return result > 1e-300 ? result : 1;  // its reciprocal is finite
}

SUTURE_CLONES
double round_rows(const double* from, SingleRow* to, std::size_t rows) {
  const double scale = largest(from, rows * 3), factor = 1 / scale;
  for (std::size_t v = 0; v < rows; ++v, from += 3)
    to[v] = SingleRow{static_cast<float>(factor * from[0]), static_cast<float>(factor * from[1]),
                      static_cast<float>(factor * from[2]), 0};
  return scale;
}

SUTURE_CLONES
void widen_rows(const SingleRow* from, double scale, double* to, std::size_t rows) {
  for (std::size_t v = 0; v < rows; ++v)
    for (std::size_t c = 0; c < 3; ++c) to[v * 3 + c] = scale * static_cast<double>(from[v][c]);
}

SUTURE_CLONES
double sum_of_products(const SingleRow* a, const SingleRow* b, std::size_t rows) {
  Doubles sum{};
  for (std::size_t i = 0; i < rows; ++i)
    sum += __builtin_convertvector(a[i], Doubles) * __builtin_convertvector(b[i], Doubles);
  return (sum[0] + sum[1]) + sum[2];
}

}  // namespace

double dot(const SingleVector& a, const SingleVector& b) {
  return sum_of_products(rows_of(a), rows_of(b), a.size() / 4);
}

double to_single(const double* from, SingleVector& to) {
  return round_rows(from, rows_of(to), to.size() / 4);
}

void to_double(const SingleVector& from, double scale, double* to) {
  widen_rows(rows_of(from), scale, to, from.size() / 4);
}

}  // namespace suture
