// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/stop_test.hpp"

#include <utility>

#include "kernel/solvers/level_solve.hpp"

namespace suture {
namespace {

constexpr unsigned test_iterations = 12;
constexpr double test_tolerance = 1e-3;

/// A uniform load on the nodes of pieces that something holds.
SingleVector load_of(const MultigridLevel& level) {
  SingleVector load = single_vector(level.nodes());
  for (std::size_t i = 0; i < level.held.size(); ++i)
    load[i / 3 * 4 + i % 3] = level.held[i] || level.loose[i / 3] ? 0.0f : 1.0f;
  return load;
}

}  // namespace

bool StopTest::converges(std::size_t l) const {
  SingleVector x;
  return solve_on_level(levels_, cycle_, l, levels_[l].multiply, load_of(levels_[l]),
                        test_tolerance, test_iterations, x) == LinearSolve::Outcome::converged;
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
