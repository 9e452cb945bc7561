// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "kernel/solvers/preconditioner.hpp"

namespace suture {

/// The end of a linear solve.
struct LinearSolve {
  enum class Outcome {
    converged,
    too_many,    ///< the allowed number of iterations was not enough
    indefinite,  ///< a direction d with d.Ad <= 0 was found: x is the iterate before it
  };
  Outcome outcome = Outcome::converged;
  unsigned iterations = 0;  ///< products with the matrix
  double residual = 0;      ///< |b - A x| / |b|, by recurrence
};

/// How long a linear solve may take.
struct IterationLimit {
  IterationLimit(unsigned most, std::function<bool()> over = {})
      : iterations(most), is_over(std::move(over)) {}
  unsigned iterations;            ///< at most
  std::function<bool()> is_over;  ///< asked before each iteration; none: they alone limit it
  bool ends(unsigned made) const { return made >= iterations || (is_over && is_over()); }
};

/// At most so many iterations; `check` is called in every 16th, and may throw.
IterationLimit checked_limit(unsigned most, const std::function<void()>& check);

/// Solves A x = b by preconditioned conjugate gradients, from x = 0, until |b - A x| <= tolerance
/// |b|. Where A turns out to be indefinite, x is a descent direction nevertheless: the last iterate
/// or, in the first iteration, B^-1 b (Nash, SIAM J. Numer. Anal. 21 (1984) 770; Dembo and
/// Steihaug, Math. Program. 26 (1983) 190).
///
/// Memory: 4 vectors, kept for the next solve. Sums have a fixed order. Throws the errors of terms,
/// and NumericalError if the tangent is not finite.
class ConjugateGradients {
 public:
  /// out = A d, or an approximation of A^-1 d; as many numbers as b has.
  using Product = std::function<void(const double* d, double* out)>;
  LinearSolve solve(const Product& a, const Product& preconditioner, std::span<const double> b,
                    std::span<double> x, double tolerance, const IterationLimit& limit,
                    const Workers* workers);
  LinearSolve solve(const TangentMatrix& a, const Preconditioner& preconditioner,
                    std::span<const double> b, std::span<double> x, double tolerance,
                    const IterationLimit& limit);

 private:
  std::vector<double> r_, z_, d_, q_;
};

/// The dot product in a fixed order, with errors that grow with the square root of the size.
double dot(std::span<const double> a, std::span<const double> b, const Workers* workers = nullptr);

/// The Euclidean norm, with that product.
inline double norm(std::span<const double> a) { return std::sqrt(dot(a, a)); }

}  // namespace suture
