// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/residual.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/attributes/held.hpp"
#include "kernel/dynamics/forces_of_step.hpp"
#include "kernel/forces/loops/dispatch.hpp"

namespace suture {
namespace {

void copy_rows(const Column& column, Index rows, std::vector<double>& to) {
  to.assign(column.rows(), column.rows() + std::size_t{rows} * 4);
}

/// visit(mass, is held, place among 4 numbers per vertex, place among 3, component).
template <class Visit>
void for_each_component(Attributes& attributes, Visit visit) {
  for (Index vertex = 0; vertex < attributes.vertex_count(); ++vertex) {
    const double mass = attributes.mass().get(vertex, 0);
    const unsigned held = held_components(attributes, vertex);
    for (std::size_t c = 0; mass > 0 && c < 3; ++c)
      visit(mass, is_held(held, c), std::size_t{vertex} * 4 + c, std::size_t{vertex} * 3 + c, c);
  }
}

}  // namespace

Residual::Residual(const Motion& motion)
    : attributes_(motion.body().attributes()),
      gravity_(motion.body().acceleration(motion.time())),
      damping_(motion.damping()) {}

Vec3 Residual::force(Index vertex) const {
  return plus(row(attributes_.force().rows(), vertex),
              scaled(attributes_.mass().get(vertex, 0), gravity_));
}

Vec3 Residual::free_force(Index vertex) const {
  Vec3 f = force(vertex);
  for (std::size_t c = 0; c < 3; ++c)
    if (is_held(held_components(attributes_, vertex), c)) f[c] = 0;
  return f;
}

Vec3 Residual::acceleration(Index vertex) const {
  const double mass = attributes_.mass().get(vertex, 0);
  const double* force = attributes_.force().rows() + std::size_t{vertex} * 4;
  const double* velocity = attributes_.velocity().rows() + std::size_t{vertex} * 4;
  Vec3 a{};
  for (std::size_t c = 0; mass > 0 && c < 3; ++c)
    a[c] = force[c] / mass + gravity_[c] - damping_ * velocity[c];
  return a;
}

void StepWork::begin(Motion& motion) {
  Attributes& attributes = motion.body().attributes();
  const Index vertices = attributes.vertex_count();
  copy_rows(attributes.position(), vertices, position_);
  copy_rows(attributes.velocity(), vertices, velocity_);
  motion.evaluate();
  copy_rows(attributes.force(), vertices, force_);
  gravity_ = motion.body().acceleration(motion.time());
}

StepSums StepWork::sums(const Motion& motion, Losses losses) const {
  Attributes& attributes = motion.body().attributes();
  const double *x = attributes.position().rows(), *v = attributes.velocity().rows(),
               *f = attributes.force().rows();
  const Vec3 gravity = motion.body().acceleration(motion.time());
  StepSums sums;
  for_each_component(
      attributes, [&](double mass, bool held, std::size_t i, std::size_t, std::size_t c) {
        const double way = x[i] - position_[i];
        const double force = (force_[i] + f[i] + mass * (gravity_[c] + gravity[c])) / 2;
        sums.work += force * way;
        sums.kinetic += mass * v[i] * v[i] / 2;
        if (held)
          sums.driven -= force * way;
        else if (losses == Losses::all)
          sums.damped += force * way - mass * (v[i] * v[i] - velocity_[i] * velocity_[i]) / 2;
        else
          sums.damped += motion.damping() * mass * (velocity_[i] + v[i]) / 2 * way;
      });
  return sums;
}

void StepWork::restore(const Motion& motion) const {
  Attributes& attributes = motion.body().attributes();
  std::ranges::copy(position_, attributes.position().rows());
  std::ranges::copy(velocity_, attributes.velocity().rows());
}

double find_residual(const Motion& motion, const ForceRows& rows, std::span<double> residual) {
  Attributes& attributes = motion.body().attributes();
  const double *x = attributes.position().rows(), *v = attributes.velocity().rows();
  double external = 0, reaction = 0, inertia = 0;
  for_each_component(
      attributes, [&](double mass, bool held, std::size_t row, std::size_t i, std::size_t) {
        const double given = rows.load[row] - (rows.held_back.empty() ? 0 : rows.held_back[i]);
        residual[i] = 0;
        if (held) {
          reaction += (rows.force[row] + given) * (rows.force[row] + given);
          return;
        }
        const double moved =
            mass * (rows.acceleration * (x[row] - rows.position[row]) + motion.damping() * v[row]);
        residual[i] = rows.force[row] + given - moved;
        external += given * given;
        inertia += moved * moved;
      });
  return std::sqrt(std::max({external, reaction, inertia}));
}

loops::RestSums RestSums::evaluate(Motion& motion) {
  constexpr Index part = 4096;
  motion.evaluate();
  const ForcesOfStep of_step(motion);
  Body& body = motion.body();
  Attributes& attributes = body.attributes();
  const std::size_t size = std::size_t{attributes.vertex_count()} * 4;
  loops::RestInput in{};
  in.position = attributes.position().rows();
  in.velocity = attributes.velocity().rows();
  in.force = attributes.force().rows();
  in.mass = attributes.mass().rows();
  in.fixed = attributes.fixed().rows();
  std::ranges::copy(body.acceleration(motion.time()), in.gravity);
  if (body.has_loads()) {
    external_.assign(size, 0);
    for (const auto& term : body.loads()) term->add_forces(motion.time(), {}, external_.data());
    in.external = external_.data();
  }
  if (old_position_.size() != size || jumps_ != motion.jumps()) {
    old_position_.assign(in.position, in.position + size);
    old_force_.assign(in.force, in.force + size);
    jumps_ = motion.jumps();
  }
  in.old_position = old_position_.data();
  in.old_force = old_force_.data();
  loops::RestSums sum{};
  for (Index begin = 0; begin < attributes.vertex_count(); begin += part) {
    const Index end = std::min(begin + part, attributes.vertex_count());
    const loops::RestSums here = hot_loops().rest_sums(&in, begin, end);
    sum.residual += here.residual;
    sum.external += here.external;
    sum.reaction += here.reaction;
    sum.kinetic += here.kinetic;
    sum.work += here.work;
    sum.inertia += here.inertia;
  }
  return sum;
}

void RestSums::state(Archive& archive) {
  archive("old position", old_position_);
  archive("old force", old_force_);
  archive("jumps", jumps_);
}

}  // namespace suture
