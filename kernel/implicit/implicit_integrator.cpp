// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/implicit/implicit_integrator.hpp"

#include <algorithm>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

void copy_rows(const Column& column, Index rows, std::vector<double>& to) {
  to.assign(column.rows(), column.rows() + std::size_t{rows} * 4);
}

}  // namespace

ImplicitIntegrator::ImplicitIntegrator(Motion& motion, const IntegratorOptions& options)
    : Integrator(motion), newton_(motion, options.tolerance, options.holds_free_pieces) {}

std::string ImplicitIntegrator::describe_solver(double dt) {
  set_equations(dt);
  return newton_.describe_solver(equations_);
}

/// The equations of a step from the current state, which is kept for reject().
void ImplicitIntegrator::set_equations(double dt) {
  Attributes& attributes = motion_.body().attributes();
  const Index vertices = attributes.vertex_count();
  copy_rows(attributes.position(), vertices, position_);
  copy_rows(attributes.velocity(), vertices, velocity_);
  motion_.evaluate();
  copy_rows(attributes.force(), vertices, force_);
  const double end = motion_.time() + dt;
  equations_ = {end, dt, 0, 0, position_, velocity_};
  set(equations_);
}

void ImplicitIntegrator::begin(double dt) {
  motion_.evaluate();
  for (const auto& term : motion_.body().terms()) term->begin_step(motion_.time());
  newton_.begin_step();
  set_equations(dt);
  solve(equations_);
}

void ImplicitIntegrator::solve(const StepEquations& equations) {
  try {
    newton_.solve(equations);
  } catch (const StepRejected&) {
    throw;
  } catch (const NumericalError& error) {
    throw StepRejected(error.what(), 0.5, error.element);
  }
}

void ImplicitIntegrator::accept(double end) {
  motion_.body().constraints().apply(motion_.body().attributes(), end);
  const Vec3 before = motion_.body().acceleration(motion_.time());
  motion_.arrive(equations_.dt, end);
  motion_.sums().add_step(sums(before));
}

void ImplicitIntegrator::reject() {
  Attributes& attributes = motion_.body().attributes();
  std::ranges::copy(position_, attributes.position().rows());
  std::ranges::copy(velocity_, attributes.velocity().rows());
  for (const auto& term : motion_.body().terms())  // multipliers of the attempt go
    term->begin_step(motion_.time());
  newton_.reject_step();
  motion_.discard_forces();
}

/// Work with the mean of the forces at both ends of the step.
StepSums ImplicitIntegrator::sums(const Vec3& gravity_before) const {
  Attributes& attributes = motion_.body().attributes();
  const double *x = attributes.position().rows(), *v = attributes.velocity().rows(),
               *f = attributes.force().rows();
  const Vec3 gravity = motion_.body().acceleration(motion_.time());
  StepSums sums;
  for (Index vertex = 0; vertex < attributes.vertex_count(); ++vertex) {
    const double mass = attributes.mass().get(vertex, 0);
    const int fixed = static_cast<int>(attributes.fixed().get(vertex, 0));
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t i = std::size_t{vertex} * 4 + c;
      const double way = x[i] - position_[i];
      const double force = (force_[i] + f[i] + mass * (gravity_before[c] + gravity[c])) / 2;
      sums.work += force * way;
      sums.kinetic += mass * v[i] * v[i] / 2;
      if ((fixed >> c & 1) != 0)
        sums.driven -= force * way;
      else
        sums.damped += motion_.damping() * mass * (velocity_[i] + v[i]) / 2 * way;
    }
  }
  return sums;
}

}  // namespace suture
