// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/dynamics_impl.hpp"

namespace suture {

Dynamics::Rounding Dynamics::rounding() const {
  if (impl_->last_dt == 0) return {};
  const Column &position = impl_->attributes.position(), &mass = impl_->attributes.mass();
  const double omega = 2 / impl_->last_dt, epsilon = std::numeric_limits<double>::epsilon();
  const double* x = position.rows();
  Rounding sum;
  for (Index v = 0; v < impl_->attributes.vertex_count(); ++v, x += 4) {
    const double stiffness = mass.rows()[v] * omega * omega;
    const double squared = epsilon * epsilon * (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    sum.energy += stiffness * squared / 2;
    sum.force_squared += stiffness * stiffness * squared;
  }
  return sum;
}

double Dynamics::Impl::external_potential() const {
  const double* rest = attributes.rest().rows();
  const double* position = attributes.position().rows();
  const double* mass = attributes.mass().rows();
  const double ramp = options.gravity_ramp.value(time);
  double sum = 0;
  for (Index v = 0; v < attributes.vertex_count(); ++v) {
    const std::size_t at = std::size_t{v} * 4;
    double work = 0;
    for (std::size_t c = 0; c < 3; ++c)
      work += options.gravity[c] * (position[at + c] - rest[at + c]);
    sum -= mass[v] * work;
  }
  return ramp * sum + loads.potential(position, time);
}

Dynamics::Energies Dynamics::energies() {
  const double kinetic = impl_->kinetic();
  return {kinetic, impl_->forces.energy(impl_->time), impl_->external_potential()};
}

EnergyBalance Dynamics::balance() {
  const EnergyBalance balance = impl_->ledger.balance(impl_->now());
  // Motion that rounding can make has no frequency: 1000 times that of a step.
  const double parts_count = parts(impl_->attributes.vertex_count(), pass_chunk);
  const double way = impl_->last_dt * impl_->last_dt * rounding().energy / 2;
  impl_->ledger.sums.set_noise(1e6 * way / parts_count);
  return balance;
}

double Dynamics::apparent_frequency() const { return impl_->ledger.sums.apparent_frequency(); }

Index Dynamics::fastest_vertex() const {
  const Index chunk = impl_->ledger.sums.fastest_chunk(),
              vertices = impl_->attributes.vertex_count();
  const Index first = chunk == none ? 0 : chunk * pass_chunk;
  const Index last = chunk == none ? vertices : std::min(first + pass_chunk, vertices);
  const auto energy = [&](Index v) {
    const double* row = impl_->attributes.velocity().rows() + std::size_t{v} * 4;
    return impl_->attributes.mass().get(v, 0) *
           (row[0] * row[0] + row[1] * row[1] + row[2] * row[2]);
  };
  Index fastest = first;
  double most = -1;
  for (Index v = first; v < last; ++v)
    if (impl_->complex->exists(0, v) && energy(v) > most) most = energy(fastest = v);
  return fastest;
}

double Dynamics::stable_step(bool from_random) {
  if (from_random) impl_->step_search.forget();
  if (impl_->forces.has_tangent()) {
    const double dt = impl_->step_search.largest(impl_->time);
    if (dt > 0) return dt;  // false if the state is beyond numbers
  }
  return bounds().dt;
}

ForceLoop::Bounds Dynamics::bounds() { return impl_->forces.bounds(impl_->time); }

ForceLoop::Bounds Dynamics::bounds_of_changes() {
  return impl_->forces.bounds_around(impl_->changed.take(*impl_->complex), impl_->time);
}

std::vector<Index> Dynamics::inverted_elements() const {
  const Index elements = impl_->complex->element_count();
  const Index* nodes = impl_->complex->vertices().data()->data();
  const std::uint8_t* live = impl_->attributes.kernel(3).cells.live().data();
  const double* position = impl_->attributes.position().rows();
  std::vector<Index> found;
  for (Index begin = 0; begin < elements; begin += sum_chunk) {
    Index first = none;
    const Index end = std::min(begin + sum_chunk, elements);
    Index here = impl_->loops.inverted(nodes, live, position, begin, end, &first);
    for (Index e = first; here > 0; ++e)
      if (impl_->loops.inverted(nodes, live, position, e, e + 1, &first) != 0) {
        found.push_back(e);
        --here;
      }
  }
  return found;
}

loops::RestSums Dynamics::Impl::rest_sums() {
  evaluate(last_dt);
  const std::size_t size = std::size_t{attributes.vertex_count()} * 4;
  loops::RestInput in{};
  in.position = attributes.position().rows();
  in.velocity = attributes.velocity().rows();
  in.force = attributes.force().rows();
  in.mass = attributes.mass().rows();
  in.fixed = attributes.fixed().rows();
  std::ranges::copy(gravity.at(time), in.gravity);
  if (!loads.empty()) {
    external.assign(size, 0);
    loads.add_to(external.data(), in.position, time);
    in.external = external.data();
  }
  if (old_position.size() != size) {
    old_position.assign(in.position, in.position + size);
    old_force.assign(in.force, in.force + size);
  }
  in.old_position = old_position.data();
  in.old_force = old_force.data();
  loops::RestSums sum{};
  for (Index begin = 0; begin < attributes.vertex_count(); begin += sum_chunk) {
    const Index end = std::min(begin + sum_chunk, attributes.vertex_count());
    const loops::RestSums part = loops.rest_sums(&in, begin, end);
    sum.residual += part.residual;
    sum.external += part.external;
    sum.reaction += part.reaction;
    sum.kinetic += part.kinetic;
    sum.work += part.work;
    sum.inertia += part.inertia;
  }
  return sum;
}

loops::RestSums Dynamics::rest_sums() { return impl_->rest_sums(); }

}  // namespace suture
