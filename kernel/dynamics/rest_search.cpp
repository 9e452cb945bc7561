// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/rest_search.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "kernel/base/saturate.hpp"
#include "kernel/dynamics/inversion.hpp"

namespace suture {
namespace {

constexpr std::uint64_t steps_between_checks = 10;
constexpr std::uint64_t steps_between_roundings = 100;  // a pass over the vertices
constexpr unsigned checks_needed = 10;
constexpr double quench_factor = 4;  // of the damping, per stage
constexpr double quench_end = 1;     // alpha dt

}  // namespace

RestSearch::RestSearch(double tolerance, bool choose_damping)
    : tolerance_(tolerance), choose_damping_(choose_damping) {}

void RestSearch::restart() {
  stagnation_.restart();
  limited_ = false;
  passed_checks_ = 0;
  quenched_until_ = 0;
}

void RestSearch::estimate_frequency(Dynamics& dynamics, const loops::RestSums& sums) {
  if (steps_ % steps_between_roundings == 0 || rounding_.energy == 0)
    rounding_ = rounding_of(dynamics.motion());
  dt_ = (dynamics.time() - checked_at_) / static_cast<double>(steps_between_checks);
  // A body that leaves an unstable state moves along forces that grow: such a time counts a
  // tenth.
  watched_time_ += (sums.work > 0 ? 1 : 0.1) * (dynamics.time() - checked_at_);
  checked_at_ = dynamics.time();
  // Softening, no motion, or noise: keep.
  if (!(sums.work > 100 * rounding_.energy) || !(sums.inertia > 0)) return;
  frequency_ = std::sqrt(sums.work / sums.inertia);
  if (choose_damping_ && quenched_until_ == 0) dynamics.motion().set_damping(2 * frequency_);
}

/// Kinetic over elastic energy.
double RestSearch::remaining_motion(Dynamics& dynamics, const loops::RestSums& sums) const {
  const Body& body = dynamics.body();
  double elastic = body.energy(dynamics.time());
  if (elastic == 0) elastic = std::abs(body.potential(dynamics.time())) / 2;
  return sums.kinetic == 0 ? 0 : sums.kinetic / elastic;
}

/// Without a load or a motion ten times the rounding of a step, as noise adds up.
bool RestSearch::is_noise(const loops::RestSums& sums, const Dynamics& dynamics) const {
  if (sums.external > 0) {
    const double decay = std::max(dynamics.motion().damping() * dt_, 1e-4);
    return sums.residual <= rounding_.force_squared * (1 + 1 / (16 * decay));
  }
  return sums.residual <= 100 * rounding_.force_squared && sums.kinetic <= 100 * rounding_.energy;
}

/// The next stage of damping, for as long as noise needs to decay; false after the last.
bool RestSearch::quench(Dynamics& dynamics) {
  if (!choose_damping_) return false;
  if (steps_ < quenched_until_) return true;
  const double alpha = dynamics.motion().damping();
  if (alpha * dt_ >= quench_end || !(alpha > 0)) return false;
  const double next = std::min(quench_factor * alpha, quench_end / dt_);
  dynamics.motion().set_damping(next);
  const auto decay = std::uint64_t{saturate<std::uint32_t>(std::ceil(8 / (next * dt_)))};
  quenched_until_ = steps_ + std::max(decay, steps_between_checks * 2 * checks_needed);
  return true;
}

bool RestSearch::at_rest(Dynamics& dynamics) {
  if (++steps_ % steps_between_checks != 0) return false;
  const loops::RestSums sums = sums_.evaluate(dynamics.motion());
  estimate_frequency(dynamics, sums);
  force_ = std::sqrt(sums.residual);
  const double scale = sums.external > 0 ? sums.external : sums.reaction;
  residual_ = scale > 0 ? force_ / std::sqrt(scale) : force_;
  if (dynamics.time() < std::max(earliest_, dynamics.body().last_change())) {
    passed_checks_ = 0;
    return false;
  }
  double distance = residual_ / tolerance_;
  if (distance < 1) {
    motion_ = std::sqrt(remaining_motion(dynamics, sums));
    distance = std::max(distance, motion_ / tolerance_);
  }
  stagnation_.add(steps_, watched_time_, distance,
                  slow_rate(frequency_, dynamics.motion().damping()));
  const bool noise = is_noise(sums, dynamics);
  if (noise && sums.external == 0) {
    residual_ = 0;
    distance = 0;
  }
  passed_checks_ = distance <= 1 ? passed_checks_ + 1 : 0;
  const bool at_noise = quenched_until_ > 0 || (noise && stagnation_.idle_windows() > 0);
  limited_ = passed_checks_ == 0 && at_noise && !quench(dynamics);
  return passed_checks_ >= checks_needed || limited_;
}

std::string RestSearch::explanation(Dynamics& dynamics) const {
  std::ostringstream text;
  if (limited_) {
    text << "the residual does not fall below " << residual_ << " (/solver/tolerance is "
         << tolerance_ << "): the rounding of positions limits it; the state counts as at rest";
    return text.str();
  }
  text << "no rest was reached: the residual is " << residual_;
  if (residual_ < tolerance_)
    text << ", but the root of kinetic over elastic energy is " << motion_;
  text << " (/solver/tolerance is " << tolerance_ << ") and has not decreased for "
       << stagnation_.steps_without_progress() << " steps, although it is far above rounding; ";
  if (dynamics.motion().damping() == 0)
    text << "the motion is undamped: set /solver/damping to \"auto\"";
  else if (const auto inverted =
               find_inverted(dynamics.body().complex(), dynamics.body().attributes());
           !inverted.empty())
    text << "inverted elements (" << inverted.size()
         << ") have no stable state: reduce the load or refine the mesh there";
  else if (!dynamics.body().is_conservative(dynamics.time()))
    text << "a pressure that follows the surface, or a model without an energy, can sustain a "
            "vibration: set /solver/end or "
            "increase /solver/damping";
  else
    text << "there may be no equilibrium near this state, or a model sustains a vibration: reduce "
            "the load, add constraints, increase /solver/damping, or set /solver/end";
  return text.str();
}

void RestSearch::state(Archive& archive) {
  archive("residual", residual_);
  archive("force", force_);
  archive("frequency", frequency_);
  archive("dt", dt_);
  archive("checked at", checked_at_);
  archive("watched", watched_time_);
  archive("rounding energy", rounding_.energy);
  archive("rounding force", rounding_.force_squared);
  archive("stagnation", stagnation_);
  archive("sums", sums_);
  archive("limited", limited_);
  archive("quenched until", quenched_until_);
  archive("steps", steps_);
  archive("good checks", passed_checks_);
}

}  // namespace suture
