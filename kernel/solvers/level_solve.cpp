// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/level_solve.hpp"

#include <utility>

namespace suture {
LinearSolve::Outcome solve_on_level(MultigridLevels& levels, const VCycle& cycle, std::size_t l,
                                    const SingleProduct& multiply, SingleVector r, double tolerance,
                                    unsigned max_iterations, SingleVector& x) {
  using enum LinearSolve::Outcome;
  MultigridLevel& level = levels[l];
  const auto product = [&](const SingleVector& a, const SingleVector& b) {
    return dot(a, b, level.workers);
  };
  SingleVector d = single_vector(level.nodes()), q = d;
  x = d;
  const double target = tolerance * tolerance * product(r, r);
  double rz = 0;
  for (unsigned i = 0; product(r, r) > target; ++i) {
    if (i == max_iterations) return too_many;
    level.r = r;
    cycle.run(l);
    const double last = std::exchange(rz, product(r, level.x));
    const auto keep = static_cast<float>(i == 0 ? 0 : rz / last);
    for (std::size_t k = 0; k < d.size(); ++k) d[k] = level.x[k] + keep * d[k];
    multiply(d.data(), q.data());
    const double curvature = product(d, q);
    if (!(curvature > 0)) {
      if (i == 0) x = d;
      return indefinite;
    }
    const auto step = static_cast<float>(rz / curvature);
    for (std::size_t k = 0; k < r.size(); ++k) {
      x[k] += step * d[k];
      r[k] -= step * q[k];
    }
  }
  return converged;
}

}  // namespace suture
