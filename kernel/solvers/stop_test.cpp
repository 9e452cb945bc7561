// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/stop_test.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace suture {
namespace {

constexpr unsigned max_iterations = 12;
constexpr double tolerance = 1e-3;

/// A uniform load on the nodes of pieces that something holds.
SingleVector load_of(const MultigridLevel& level) {
  SingleVector load = single_vector(level.nodes());
  for (std::size_t i = 0; i < level.held.size(); ++i)
    load[i / 3 * 4 + i % 3] = level.held[i] || level.loose[i / 3] ? 0.0f : 1.0f;
  return load;
}

}  // namespace

/// Conjugate gradients with the cycle from level l.
bool StopTest::converges(std::size_t l) const {
  MultigridLevel& level = levels_[l];
  SingleVector r = load_of(level), d = single_vector(level.nodes()), q = d;
  const double target = tolerance * tolerance * dot(r, r);
  double rz = 0;
  for (unsigned i = 0; dot(r, r) > target; ++i) {
    if (i == max_iterations) return false;
    level.r = r;
    cycle_.run(l);
    const double last = std::exchange(rz, dot(r, level.x));
    const auto keep = static_cast<float>(i == 0 ? 0 : rz / last);
    for (std::size_t k = 0; k < d.size(); ++k) d[k] = level.x[k] + keep * d[k];
    level.multiply(d.data(), q.data());
    const double curvature = dot(d, q);
    if (!(curvature > 0)) return false;
    const auto step = static_cast<float>(rz / curvature);
    for (std::size_t k = 0; k < r.size(); ++k) r[k] -= step * q[k];
  }
  return true;
}

/// False if it is not affordable; then the coarsest level keeps its factor.
bool StopTest::make_factor(std::size_t l) {
  const BlockPattern& pattern = levels_[l].pattern;
  if (static_cast<double>(pattern.column.size()) > max_blocks_) return false;
  FactoredRows candidate;
  if (candidate.analyse(pattern) > max_operations_) return false;
  coarsest_ = std::move(candidate);
  return true;
}

std::size_t StopTest::next_direct_level() {
  if (!on_grid_) return std::exchange(next_, 0) > 1 && !converges(0) ? finest_affordable() : 0;
  while (next_ > 1)
    if (const std::size_t l = --next_; !converges(l)) {
      // Finer levels are more expensive still.
      if (!make_factor(l)) next_ = 0;
      return next_;
    }
  return 0;
}

std::size_t StopTest::finest_affordable() {
  for (std::size_t l = 1; l + 1 < levels_.size(); ++l)
    if (make_factor(l)) return l;
  return 0;
}

}  // namespace suture
