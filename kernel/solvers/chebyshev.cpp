// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/chebyshev.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "kernel/solvers/clones.hpp"

namespace suture {
namespace {

typedef float Unaligned __attribute__((vector_size(16), aligned(4), may_alias));

/// An inverse diagonal block (xx, yy, zz, xy, yz, xz), symmetric, times a row. The fourth numbers
/// that are loaded meet the 0 of the row.
inline __attribute__((always_inline)) SingleRow precondition(const float* block, SingleRow r) {
  const SingleRow diagonal = *reinterpret_cast<const Unaligned*>(block);
  const SingleRow sides = *reinterpret_cast<const Unaligned*>(block + 3);
  const SingleRow next = __builtin_shufflevector(r, r, 1, 2, 0, 3);
  const SingleRow last = __builtin_shufflevector(r, r, 2, 0, 1, 3);
  return diagonal * r + (sides * next + __builtin_shufflevector(sides, sides, 2, 0, 1, 3) * last);
}

/// The coefficients of one term of the polynomial: d = keep d + add D^-1 r, x += part d.
struct Term {
  float keep, add, part;
};

// The passes over the vectors of a level. Each reads and writes as much as it can at once.

/// d = add D^-1 r, x = part d.
SUTURE_CLONES
void begin(const Term& term, const float* inverse, const SingleRow* r, SingleRow* d, SingleRow* x,
           std::size_t rows) {
  for (std::size_t i = 0; i < rows; ++i) {
    d[i] = term.add * precondition(inverse + 6 * i, r[i]);
    x[i] = term.part * d[i];
  }
}

/// s = r - q, r -= last q, d = keep d + add D^-1 s, x += part d. `r` may be `from`.
SUTURE_CLONES
void advance(const Term& term, float last, const float* inverse, const SingleRow* q,
             const SingleRow* from, SingleRow* s, SingleRow* r, SingleRow* d, SingleRow* x,
             std::size_t rows) {
  for (std::size_t i = 0; i < rows; ++i) {
    const SingleRow next = from[i] - q[i];
    r[i] -= last * q[i];
    s[i] = next;
    d[i] = term.keep * d[i] + term.add * precondition(inverse + 6 * i, next);
    x[i] += term.part * d[i];
  }
}

/// The same with r = s.
SUTURE_CLONES
void advance(const Term& term, const float* inverse, const SingleRow* q, SingleRow* r, SingleRow* d,
             SingleRow* x, std::size_t rows) {
  for (std::size_t i = 0; i < rows; ++i) {
    r[i] -= q[i];
    d[i] = term.keep * d[i] + term.add * precondition(inverse + 6 * i, r[i]);
    x[i] += term.part * d[i];
  }
}

/// r -= q, d = add D^-1 r, x += correction + part d.
SUTURE_CLONES
void begin_corrected(const Term& term, const float* inverse, const SingleRow* q,
                     const SingleRow* correction, SingleRow* r, SingleRow* d, SingleRow* x,
                     std::size_t rows) {
  for (std::size_t i = 0; i < rows; ++i) {
    r[i] -= q[i];
    d[i] = term.add * precondition(inverse + 6 * i, r[i]);
    x[i] += correction[i] + term.part * d[i];
  }
}

/// y += factor x.
SUTURE_CLONES
void add(float factor, const SingleRow* x, SingleRow* y, std::size_t rows) {
  for (std::size_t i = 0; i < rows; ++i) y[i] += factor * x[i];
}

/// z = D^-1 r; returns r . z.
SUTURE_CLONES
double precondition(const float* inverse, const SingleRow* r, SingleRow* z, std::size_t rows) {
  typedef double Doubles __attribute__((vector_size(32)));
  Doubles sum{};
  for (std::size_t i = 0; i < rows; ++i) {
    z[i] = precondition(inverse + 6 * i, r[i]);
    sum += __builtin_convertvector(r[i], Doubles) * __builtin_convertvector(z[i], Doubles);
  }
  return (sum[0] + sum[1]) + sum[2];
}

/// d = z + keep d.
SUTURE_CLONES
void combine(float keep, const SingleRow* z, SingleRow* d, std::size_t rows) {
  for (std::size_t i = 0; i < rows; ++i) d[i] = z[i] + keep * d[i];
}

/// Numbers in [-0.5, 0.5), the same in every call: short waves have the largest eigenvalues.
SingleVector random_vector(std::size_t rows) {
  SingleVector result = single_vector(rows);
  std::uint32_t state = 1;
  for (std::size_t i = 0; i < rows * 4; ++i) {
    state = state * 1664525u + 1013904223u;
    if (i % 4 != 3) result[i] = static_cast<float>(state >> 8) * 0x1p-24f - 0.5f;
  }
  return result;
}

/// The matrix D^-1 A in the basis of Lanczos' method, from the coefficients of conjugate gradients.
class Tridiagonal {
 public:
  void add(double step, double keep) {
    diagonal_.push_back(1 / step + (diagonal_.empty() ? 0 : keep / last_));
    if (diagonal_.size() > 1) below_.push_back(std::sqrt(keep) / last_);
    last_ = step;
  }
  double largest() const {
    if (diagonal_.empty()) return 0;
    const auto size = static_cast<Eigen::Index>(diagonal_.size());
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(Eigen::Map<const Eigen::VectorXd>(diagonal_.data(), size),
                                  Eigen::Map<const Eigen::VectorXd>(below_.data(), size - 1),
                                  Eigen::EigenvaluesOnly);
    return solver.eigenvalues()[size - 1];
  }

 private:
  std::vector<double> diagonal_, below_;
  double last_ = 1;
};

/// How much of each term is added to x, for polynomials of 1 to 4 terms: the best ones for a
/// V-cycle (Phillips and Fischer, arXiv:2210.03179, table 1).
constexpr unsigned max_steps = 4;
constexpr double parts[max_steps][max_steps] = {
    {1.125},
    {1.02387287570313, 1.26408905371085},
    {1.00842544782028, 1.08867839208730, 1.33753125909618},
    {1.00391310427285, 1.04035811188593, 1.14863498546254, 1.38268869241000}};

/// Term i of a polynomial of `steps` terms for this largest eigenvalue.
Term term_of(unsigned i, unsigned steps, float largest) {
  const auto odd = static_cast<float>(2 * i + 3);
  const double part = steps <= max_steps ? parts[steps - 1][i] : 1;
  return {i == 0 ? 0 : static_cast<float>(2 * i - 1) / odd,
          static_cast<float>(8 * i + 4) / (odd * largest), static_cast<float>(part)};
}

}  // namespace

void Chebyshev::set(const DiagonalBlocks& inverse, const SingleProduct& multiply,
                    const Workers* workers) {
  // The estimate is a lower bound.
  constexpr double safety = 1.1;
  workers_ = workers;
  inverse_.assign(inverse.size() * 6 + 1, 0);
  for_vector_chunks(inverse.size(), workers_, [&](std::size_t first, std::size_t rows) {
    for (std::size_t v = first; v < first + rows; ++v) {
      const Eigen::Matrix3f b = inverse[v].cast<float>();
      const float values[] = {b(0, 0), b(1, 1), b(2, 2), b(1, 0), b(2, 1), b(2, 0)};
      std::ranges::copy(values, inverse_.data() + v * 6);
    }
  });
  d_ = single_vector(inverse.size());
  q_ = single_vector(inverse.size());
  s_ = single_vector(inverse.size());
  largest_ = static_cast<float>(safety * estimate(multiply));
}

/// As good as 20 steps of power iteration.
double Chebyshev::estimate(const SingleProduct& multiply) const {
  constexpr unsigned steps = 10;
  const std::size_t rows = d_.size() / 4;
  SingleVector r = random_vector(rows);
  Tridiagonal lanczos;
  double rz = 0;
  for (unsigned i = 0; i < steps; ++i) {
    const double last = std::exchange(
        rz, sum_vector_chunks(rows, workers_, [&](std::size_t first, std::size_t count) {
          return precondition(&inverse_[6 * first], rows_of(r) + first, rows_of(s_) + first, count);
        }));
    const double keep = i == 0 ? 0 : rz / last;
    if (!(rz > 0)) break;
    for_vector_chunks(rows, workers_, [&](std::size_t first, std::size_t count) {
      combine(static_cast<float>(keep), rows_of(s_) + first, rows_of(d_) + first, count);
    });
    multiply(d_.data(), q_.data());
    const double step = rz / dot(d_, q_, workers_);
    if (!std::isfinite(step)) break;
    lanczos.add(step, keep);
    add(static_cast<float>(-step), q_, r);
  }
  return lanczos.largest();
}

void Chebyshev::add(float factor, const SingleVector& from, SingleVector& to) const {
  for_vector_chunks(to.size() / 4, workers_, [&](std::size_t first, std::size_t rows) {
    suture::add(factor, rows_of(from) + first, rows_of(to) + first, rows);
  });
}

void Chebyshev::smooth(const SingleProduct& multiply, unsigned steps, SingleVector& x,
                       SingleVector& r) const {
  if (!(largest_ > 0)) {
    std::ranges::fill(x, 0.0f);
    return;
  }
  const std::size_t rows = x.size() / 4;
  Term term = term_of(0, steps, largest_);
  for_vector_chunks(rows, workers_, [&](std::size_t first, std::size_t count) {
    begin(term, &inverse_[6 * first], rows_of(r) + first, rows_of(d_) + first, rows_of(x) + first,
          count);
  });
  for (unsigned i = 1;; ++i) {
    multiply(d_.data(), q_.data());
    const float last = term.part;
    if (i == steps) return add(-last, q_, r);
    term = term_of(i, steps, largest_);
    for_vector_chunks(rows, workers_, [&](std::size_t first, std::size_t count) {
      advance(term, last, &inverse_[6 * first], rows_of(q_) + first,
              rows_of(i == 1 ? r : s_) + first, rows_of(s_) + first, rows_of(r) + first,
              rows_of(d_) + first, rows_of(x) + first, count);
    });
  }
}

void Chebyshev::correct(const SingleProduct& multiply, unsigned steps,
                        const SingleVector& correction, SingleVector& x, SingleVector& r) const {
  if (!(largest_ > 0)) return add(1, correction, x);
  const std::size_t rows = x.size() / 4;
  multiply(correction.data(), q_.data());
  for_vector_chunks(rows, workers_, [&](std::size_t first, std::size_t count) {
    begin_corrected(term_of(0, steps, largest_), &inverse_[6 * first], rows_of(q_) + first,
                    rows_of(correction) + first, rows_of(r) + first, rows_of(d_) + first,
                    rows_of(x) + first, count);
  });
  for (unsigned i = 1; i < steps; ++i) {
    multiply(d_.data(), q_.data());
    for_vector_chunks(rows, workers_, [&](std::size_t first, std::size_t count) {
      advance(term_of(i, steps, largest_), &inverse_[6 * first], rows_of(q_) + first,
              rows_of(r) + first, rows_of(d_) + first, rows_of(x) + first, count);
    });
  }
}

}  // namespace suture
