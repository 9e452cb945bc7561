// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/implicit/implicit_integrator.hpp"

#include "kernel/base/error.hpp"

namespace suture {
ImplicitIntegrator::ImplicitIntegrator(Motion& motion, const IntegratorOptions& options)
    : Integrator(motion), newton_(motion, options.tolerance, options.holds_free_pieces) {}

const StepEquations* ImplicitIntegrator::equations(double dt) {
  set_equations(dt);
  return &equations_;
}

std::string ImplicitIntegrator::describe_solver(double dt) {
  set_equations(dt);
  return newton_.describe_solver(equations_);
}

/// The equations of a step from the current state, which is kept for reject().
void ImplicitIntegrator::set_equations(double dt) {
  work_.begin(motion_);
  const double end = motion_.time() + dt;
  equations_ = {end, dt, 0, 0, work_.position(), work_.velocity()};
  set(equations_);
}

void ImplicitIntegrator::begin(double dt) {
  newton_.begin_step();
  set_equations(dt);
  for_each_with<ConstraintTerm>(motion_.body().terms(),
                                [&](ConstraintTerm& term) { term.begin_step(motion_.time()); });
  solve(equations_);
}

/// From the positions that are reached: the solution is near.
void ImplicitIntegrator::repeat() {
  equations_.is_predicted = false;
  motion_.discard_forces();
  ImplicitIntegrator::solve(equations_);
}

void ImplicitIntegrator::find(const StepEquations& equations) { newton_.solve(equations); }

void ImplicitIntegrator::solve(const StepEquations& equations) {
  try {
    find(equations);
  } catch (const StepRejected&) {
    throw;
  } catch (const NumericalError& error) {
    throw StepRejected(error.what(), 0.5, error.element);
  }
}

void ImplicitIntegrator::accept(double end) {
  motion_.body().constraints().apply(motion_.body().attributes(), end);
  motion_.arrive(equations_.dt, end);
  motion_.sums().add_step(work_.sums(motion_));
}

void ImplicitIntegrator::reject() {
  work_.restore(motion_);
  for_each_with<ConstraintTerm>(motion_.body().terms(),
                                [](ConstraintTerm& term) { term.reject_step(); });
  newton_.reject_step();
  motion_.discard_forces();
}

}  // namespace suture
