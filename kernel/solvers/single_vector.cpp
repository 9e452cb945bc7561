// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/single_vector.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/solvers/clones.hpp"

namespace suture {
namespace {

typedef double Doubles __attribute__((vector_size(32), aligned(8), may_alias));

/// The largest magnitude.
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
  return result;
}

SUTURE_CLONES
double largest_of_rows(const double* from, std::size_t rows) { return largest(from, rows * 3); }

SUTURE_CLONES
void round_rows(const double* from, double factor, SingleRow* to, std::size_t rows) {
  for (std::size_t v = 0; v < rows; ++v, from += 3)
    to[v] = SingleRow{static_cast<float>(factor * from[0]), static_cast<float>(factor * from[1]),
                      static_cast<float>(factor * from[2]), 0};
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

double dot(const SingleVector& a, const SingleVector& b, const Workers* workers) {
  return sum_vector_chunks(a.size() / 4, workers, [&](std::size_t first, std::size_t rows) {
    return sum_of_products(rows_of(a) + first, rows_of(b) + first, rows);
  });
}

double to_single(const double* from, SingleVector& to, const Workers* workers) {
  const std::size_t rows = to.size() / 4;
  std::vector<double> most(rows / vector_chunk + 1);
  for_vector_chunks(rows, workers, [&](std::size_t first, std::size_t count) {
    most[first / vector_chunk] = largest_of_rows(from + 3 * first, count);
  });
  double scale = std::ranges::max(most);
  if (!(scale > 1e-300)) scale = 1;  // its reciprocal is finite
  for_vector_chunks(rows, workers, [&](std::size_t first, std::size_t count) {
    round_rows(from + 3 * first, 1 / scale, rows_of(to) + first, count);
  });
  return scale;
}

void to_double(const SingleVector& from, double scale, double* to, const Workers* workers) {
  for_vector_chunks(from.size() / 4, workers, [&](std::size_t first, std::size_t rows) {
    widen_rows(rows_of(from) + first, scale, to + 3 * first, rows);
  });
}

}  // namespace suture
