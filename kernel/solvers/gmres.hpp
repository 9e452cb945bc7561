// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/solvers/conjugate_gradients.hpp"

namespace suture {

/// Preconditioned generalised minimal residuals (Saad and Schultz, SIAM J. Sci. Stat. Comput. 7
/// (1986) 856), for tangents that are not symmetric. Restarted after 40
/// iterations; one vector per iteration.
class Gmres {
 public:
  /// Solves A x = b with the whole tangent (TangentMatrix::apply_whole) from x = 0 until |r| <=
  /// tolerance |b|, or as long as the limit allows. Throws the errors of terms, and NumericalError
  /// if a product is not finite.
  LinearSolve solve(const TangentMatrix& a, const Preconditioner& preconditioner,
                    std::span<const double> b, std::span<double> x, double tolerance,
                    const IterationLimit& limit);

 private:
  unsigned cycle(const TangentMatrix& a, const Preconditioner& preconditioner, std::span<double> x,
                 double target, const IterationLimit& limit);

  std::vector<std::vector<double>> basis_;
  std::vector<double> r_, z_;
};

}  // namespace suture
