// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/rest_search.hpp"

#include <cmath>

namespace suture {
namespace {

constexpr std::uint64_t steps_between_checks = 10;
constexpr unsigned checks_needed = 10;

/// Without a load or a motion there is nothing to compare with but rounding: ten times
/// that of a step, as noise adds up.
bool is_noise(const Dynamics& dynamics, const loops::RestSums& sums) {
  if (sums.external > 0) return false;
  const Dynamics::Rounding rounding = dynamics.rounding();
  return sums.residual <= 100 * rounding.force_squared && sums.kinetic <= 100 * rounding.energy;
}

}  // namespace

RestSearch::RestSearch(double tolerance, bool choose_damping)
    : tolerance_(tolerance), choose_damping_(choose_damping) {}

void RestSearch::tune(Dynamics& dynamics, const loops::RestSums& sums) {
  if (!(sums.work > 0) || !(sums.inertia > 0)) return;  // softening, or no motion: keep
  dynamics.set_damping(2 * std::sqrt(sums.work / sums.inertia));
}

bool RestSearch::at_rest(Dynamics& dynamics) {
  if (++steps_ % steps_between_checks != 0) return false;
  const loops::RestSums sums = dynamics.rest_sums();
  if (choose_damping_) tune(dynamics, sums);
  const double scale = sums.external > 0 ? sums.external : sums.reaction;
  residual_ = scale > 0 ? std::sqrt(sums.residual / scale) : std::sqrt(sums.residual);
  const bool settled = dynamics.time() >= std::max(earliest_, dynamics.settled_after());
  bool good = settled && residual_ < tolerance_;
  if (good) {
    const double elastic = dynamics.forces().energy(dynamics.time());
    good = sums.kinetic <= tolerance_ * tolerance_ * elastic;
  }
  if (!good && settled && is_noise(dynamics, sums)) {
    residual_ = 0;
    good = true;
  }
  good_checks_ = good ? good_checks_ + 1 : 0;
  return good_checks_ >= checks_needed;
}

}  // namespace suture
