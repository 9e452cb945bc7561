// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/run/guard.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

std::string when(std::uint64_t step, double time) {
  std::ostringstream text;
  text << "step " << step << ", t = " << time << " s: ";
  return text.str();
}

bool stops_on_inversion(const Scene& scene) {
  if (scene.solver.on_inversion != SolverOptions::OnInversion::by_model) {
    return scene.solver.on_inversion == SolverOptions::OnInversion::stop;
  }
  return std::any_of(scene.models.begin(), scene.models.end(), [](const ModelUse& use) {
    return (use.model->flags & SUTURE_CONTINUUM) != 0;
  });
}

// Until when somebody outside may put energy in that no potential accounts for.
double end_of_outside_work(const Scene& scene) {
  double end = 0;
  for (const Constraint& constraint : scene.constraints) {
    if (constraint.moves) end = std::max(end, constraint.ramp.to);
  }
  for (const Load& load : scene.loads) {
    if (load.kind == Load::Kind::pressure) end = std::numeric_limits<double>::infinity();
    end = std::max(end, load.ramp.to);
  }
  return end;
}

}  // namespace

Guard::Guard(const Scene& scene, World& world, Diagnostics& diagnostics)
    : world_(world),
      diagnostics_(diagnostics),
      stop_on_inversion_(stops_on_inversion(scene)),
      inverted_at_rest_(world.dynamics->inversions().count),
      quiet_after_(end_of_outside_work(scene)) {}

void Guard::check(std::uint64_t step, double time, double dt) {
  check_energy(step, time, dt);
  check_inversion(step, time);
}

// Gravity, dead loads and elasticity have potentials and damping only takes, so
//   kinetic + elastic + external  never rises above its start,
// but for the wobble of the integrator, a part of what has been exchanged. An unstable
// step multiplies the energy in every step: more than twice what the loads have given, or
// can have given before a body that swings came back, is proof, if it is more than
// rounding can have gathered.
void Guard::check_energy(std::uint64_t step, double time, double dt) {
  if (has_start_ && world_.dynamics->kinetic_energy() <= 2 * verified_kinetic_) return;
  const Dynamics::Energies energy = world_.dynamics->energies();
  verified_kinetic_ = energy.kinetic;
  if (!has_start_ || time <= quiet_after_) {
    has_start_ = true;
    start_energy_ = energy.total();
    if (std::isfinite(start_energy_)) return;
  }
  double given = std::abs(energy.external) + std::abs(start_energy_);
  const double excess = energy.total() - start_energy_;
  if (excess <= given) return;
  const double noise = 10 * static_cast<double>(step) * world_.dynamics->rounding().energy;
  given = std::max(given, world_.dynamics->most_given(world_.selector.diagonal()));
  if (excess <= given + noise) return;
  std::ostringstream text;
  text << when(step, time) << "the energy grows: " << energy.kinetic << " J kinetic and "
       << energy.elastic << " J elastic, while loads and start account for " << given
       << " J; the step is unstable. Lower /solver/dt (now " << dt << " s; stable is about "
       << world_.dynamics->stable_step() << " s) or set it to \"auto\"";
  throw NumericalError(text.str());
}

void Guard::check_inversion(std::uint64_t step, double time) {
  const Dynamics::Inversions found = world_.dynamics->inversions();
  if (found.count <= inverted_at_rest_) return;
  const Index inverted = found.count - inverted_at_rest_;
  const bool first_time = worst_inverted_ == 0;
  worst_inverted_ = std::max(worst_inverted_, inverted);
  if (!first_time && !stop_on_inversion_) return;
  std::ostringstream text;
  text << when(step, time) << inverted << (inverted == 1 ? " element is" : " elements are")
       << " inverted (a corner Jacobian <= 0)";
  if (inverted_at_rest_ == 0) text << ", the first is element " << found.first;
  if (stop_on_inversion_) {
    text << ". The load is beyond what the law or the mesh bears: lower or ramp it, refine the "
            "mesh there,"
            " choose another model, or set /solver/on_inversion to \"warn\"";
    throw NumericalError(text.str());
  }
  diagnostics_.warn(text.str() + "; the run goes on (/solver/on_inversion)");
}

}  // namespace suture
