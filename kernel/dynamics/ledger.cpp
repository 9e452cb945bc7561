// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/ledger.hpp"

#include <algorithm>
#include <cmath>

namespace suture {

Vec3 Gravity::at(double time) const {
  const double r = ramp.value(time);
  return {r * value[0], r * value[1], r * value[2]};
}

Ledger::Ledger(Attributes& attributes, ForceLoop& forces, Loads& loads, Constraints& constraints,
               const Gravity& gravity)
    : attributes_(attributes),
      forces_(forces),
      loads_(loads),
      constraints_(constraints),
      gravity_(gravity) {
  sums.resize(attributes.vertex_count());
}

void Ledger::add_forces(double time, double dt, double last_dt, const LiveMask& live) {
  using Part = ForceLoop::Part;
  if (forces_.has(Part::without_energy) && forces_.has(Part::with_energy)) {
    forces_.add_forces(time, dt, Part::without_energy);
    book_fed(last_dt);
    forces_.add_forces(time, dt, Part::with_energy);
  } else {
    forces_.add_forces(time, dt);
  }
  loads_.add_and_book(attributes_.force().rows(), attributes_.position().rows(), time, live);
  // While the ramp rises from here to the next state, or rose from the last one.
  const double now = gravity_.ramp.value(time), next = gravity_.ramp.value(time + 2 * dt);
  if (now != next || now != account_.ramp) book_gravity(time);
}

// The trapezoid between two bookings is exact where the ramp does not change between them:
//   W += (r + r') / 2 (sum m g . x' - sum m g . x)
void Ledger::book_gravity(double time) {
  const Vec3& g = gravity_.value;
  if (g == Vec3{}) return;
  const double* x = attributes_.position().rows();
  const double* mass = attributes_.mass().rows();
  double moment = 0;
  for (Index v = 0; v < attributes_.vertex_count(); ++v, x += 4)
    moment += mass[v] * (g[0] * x[0] + g[1] * x[1] + g[2] * x[2]);
  const double ramp = gravity_.ramp.value(time);
  if (account_.moment_known)
    account_.gravity += (account_.ramp + ramp) / 2 * (moment - account_.moment);
  account_.moment = moment;
  account_.ramp = ramp;
  account_.moment_known = true;
}

// W += (f + f') / 2 . h v-, the column `force` being f' and nothing else.
void Ledger::book_fed(double last_dt) {
  const std::size_t size = std::size_t{attributes_.vertex_count()} * 4;
  const double *force = attributes_.force().rows(), *velocity = attributes_.velocity().rows();
  const bool first = fed_force_.empty();
  fed_force_.resize(size);
  double work = 0;
  for (std::size_t i = 0; i < size; ++i) {
    work += (fed_force_[i] + force[i]) * velocity[i];
    fed_force_[i] = force[i];
  }
  if (!first && !fed_is_booked_) account_.fed += work * last_dt / 2;
  fed_is_booked_ = true;
}

bool Ledger::needs_work() const {
  return forces_.is_viscoelastic() || !forces_.has(ForceLoop::Part::with_energy);
}

/// Work of prescribed motion in the half step that is not complete.
double Ledger::driven_until(const Now& now) const {
  return sums.noted_driven() +
         constraints_.work_until_now(attributes_, gravity_.at(now.time), now.half_step);
}

EnergyBalance Ledger::balance(const Now& now) {
  book_gravity(now.time);
  EnergyBalance b;
  b.kinetic = now.kinetic;
  b.elastic = forces_.energy(now.time);
  const double driven = constraints_.driven_kinetic(attributes_);
  if (!account_.has_start) {
    account_.has_start = true;
    account_.start = b.kinetic + b.elastic;
    account_.start_elastic = b.elastic;
    account_.start_driven = driven;
  }
  const double stored = b.elastic - account_.start_elastic - account_.events_elastic;
  b.gravity = account_.gravity;
  b.loads = loads_.book().dead;
  b.pressure = loads_.book().pressure;
  b.prescribed = sums.driven_work() + driven_until(now) + account_.owed_driven + driven -
                 account_.start_driven;
  b.events = account_.events;
  b.dissipated = sums.damped();
  const double internal =
      sums.work() + now.work + account_.owed_work - b.gravity - b.loads - b.pressure;
  b.models = forces_.has(ForceLoop::Part::with_energy) ? account_.fed : internal;
  if (forces_.is_viscoelastic()) b.dissipated -= internal - b.models + stored;
  b.balance = b.kinetic + b.elastic - account_.start - b.gravity - b.loads - b.pressure -
              b.prescribed - b.models - b.events + b.dissipated;
  b.recoverable = now.leapfrog_part - account_.leapfrog_start;
  account_.exchanged = std::max({account_.exchanged, sums.largest_kinetic(),
                                 b.kinetic + std::abs(stored), std::abs(b.gravity),
                                 std::abs(b.loads), std::abs(b.pressure), std::abs(b.prescribed)});
  b.exchanged = account_.exchanged;
  return b;
}

void Ledger::before_jump(const Now& now) {
  book_gravity(now.time);
  jump_.leapfrog_start = now.leapfrog_part;
  jump_.start_elastic = forces_.energy(now.time);
  jump_.start = now.kinetic + jump_.start_elastic;
  jump_.start_driven = constraints_.driven_kinetic(attributes_);
  jump_.owed_driven = driven_until(now);
  jump_.owed_work = now.work;
}

void Ledger::after_jump(const Now& now) {
  const double elastic = forces_.energy(now.time);
  account_.events += now.kinetic + elastic - jump_.start;
  account_.events_elastic += elastic - jump_.start_elastic;
  account_.start_driven += constraints_.driven_kinetic(attributes_) - jump_.start_driven;
  account_.leapfrog_start += now.leapfrog_part - jump_.leapfrog_start;
  account_.owed_driven += jump_.owed_driven - driven_until(now);
  account_.owed_work += jump_.owed_work - now.work;
  book_gravity(now.time);
}

void Ledger::follow_splits() {
  sums.resize(attributes_.vertex_count());
  sums.forget_chunks();
  // Until the next evaluation the first part of a split vertex carries the force of all.
  if (!fed_force_.empty()) fed_force_.resize(std::size_t{attributes_.vertex_count()} * 4);
}

void Ledger::forget_last() {
  sums.resize(attributes_.vertex_count());
  sums.forget_last();
  loads_.forget_last();
  fed_force_.clear();
  account_.moment_known = false;
}

void Ledger::restart() {
  account_ = {};
  sums.restart();
  forget_last();
  loads_.set_book({});
}

Ledger::State Ledger::save() const {
  return {account_,   sums,          loads_.book(), constraints_.mean_velocities(),
          fed_force_, fed_is_booked_};
}

void Ledger::restore(const State& state) {
  account_ = state.account;
  sums = state.sums;
  loads_.set_book(state.loads);
  constraints_.set_mean_velocities(state.driven);
  fed_force_ = state.fed_force;
  fed_is_booked_ = state.fed_is_booked;
}

}  // namespace suture
