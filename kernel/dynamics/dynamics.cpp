// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/dynamics_impl.hpp"

namespace suture {

Dynamics::Dynamics(Attributes& attributes, const CellComplex& complex,
                   const DynamicsOptions& options)
    : impl_(std::make_unique<Impl>(attributes, complex, options)) {}
Dynamics::~Dynamics() = default;

Constraints& Dynamics::constraints() { return impl_->constraints; }
Loads& Dynamics::loads() { return impl_->loads; }
ForceLoop& Dynamics::forces() { return impl_->forces; }
const ForceLoop& Dynamics::forces() const { return impl_->forces; }
double Dynamics::time() const { return impl_->time; }

void Dynamics::start(double time) {
  const Column& mass = impl_->attributes.mass();
  for (Index v = 0; v < impl_->attributes.vertex_count(); ++v) {
    if (mass.get(v, 0) > 0 || !impl_->complex->exists(0, v)) continue;
    const Index element = impl_->complex->dart_of(0, v) / 24;
    throw InputError("element " + std::to_string(impl_->shown(element)) +
                     " has a vertex without mass: no model with a density acts on it; give the "
                     "models regions that cover the mesh");
  }
  impl_->time = time;
  impl_->constraints.apply(impl_->attributes, time);
  invalidate();
}

void Dynamics::step(double dt, double end) { impl_->step(dt, end); }
void Dynamics::synchronise() { impl_->synchronise(); }
void Dynamics::synchronise_velocities() {
  if (impl_->is_pending) impl_->synchronise();
}

void Dynamics::prepare_change(std::span<const Index> vertices, bool only_apart) {
  if (!only_apart) impl_->ledger.before_jump(impl_->now());
  impl_->changing.clear();
  if (!impl_->is_lagging()) return;
  const std::vector<Vec3> forces = impl_->forces_at(vertices);
  for (std::size_t i = 0; i < forces.size(); ++i)
    impl_->changing.push_back({vertices[i], impl_->over_mass(forces[i], vertices[i])});
}

/// Forces of models and loads; zeros where a model fails, as the step will say so.
std::vector<Vec3> Dynamics::Impl::forces_at(std::span<const Index> vertices) {
  if (vertices.empty()) return {};
  try {
    std::vector<Vec3> result = forces.forces_around(vertices, time);
    loads.add_at(forces.selection(), vertices, attributes.position().rows(), time, result);
    return result;
  } catch (const NumericalError&) {
    return {};
  }
}

Vec3 Dynamics::Impl::over_mass(const Vec3& force, Index vertex) const {
  const double mass = attributes.mass().get(vertex, 0);
  return {force[0] / mass, force[1] / mass, force[2] / mass};
}

/// The kick to come takes the forces f' after the operation for the whole time between two
/// velocities, but its first half belongs to the forces f before it:
///   e (v + g/e (f - f')/m) + g f'/m = e v + g f/m       e, g: of the first half
void Dynamics::Impl::kick_changed(const TopologyChange& change) {
  std::erase_if(changing, [&](const Changing& c) { return !complex->exists(0, c.vertex); });
  const std::size_t known = changing.size();
  if (known == 0) return;
  std::vector<Changing> parents = changing;
  std::ranges::sort(parents, {}, &Changing::vertex);
  for (const Split& split : change.splits[0]) {
    const auto parent = std::ranges::lower_bound(parents, split.old_cell, {}, &Changing::vertex);
    if (parent != parents.end() && parent->vertex == split.old_cell)
      changing.push_back({split.new_cell, parent->acceleration});
  }
  std::vector<Index> vertices;
  for (const Changing& c : changing) vertices.push_back(c.vertex);
  const std::vector<Vec3> now = forces_at(vertices);
  const Kick half = lacking();
  for (std::size_t i = 0; i < now.size(); ++i) {
    const Vec3 a = over_mass(now[i], vertices[i]);
    const int fixed = static_cast<int>(attributes.fixed().get(vertices[i], 0));
    double* v = attributes.velocity().rows() + std::size_t{vertices[i]} * 4;
    for (std::size_t c = 0; c < 3; ++c)
      if ((fixed >> c & 1) == 0)
        v[c] += half.gain / half.decay * (changing[i].acceleration[c] - a[c]);
  }
}

void Dynamics::update(const CellComplex& complex, const TopologyChange& change) {
  impl_->wake();
  impl_->complex = &complex;
  impl_->forces.update(complex, change);
  impl_->constraints.update(change, impl_->attributes);
  impl_->step_search.follow(change);
  impl_->changed.add(complex, change, impl_->forces.reads_summed_columns());
  const bool only_apart = change.faces_sewn == 0 && change.removed[3].empty();
  if (!only_apart || !change.splits[0].empty())
    impl_->loads.update(impl_->attributes.rest_places(complex));
  impl_->forget_forces();
  impl_->kick_changed(change);
  if (only_apart)
    impl_->ledger.follow_splits();
  else
    impl_->ledger.forget_last();
  if (!only_apart) impl_->ledger.after_jump(impl_->now());
}

void Dynamics::displace(std::span<const Vec3> shape, double scale) {
  prepare_change({}, false);
  Column& x = impl_->attributes.position();
  for (Index v = 0; v < impl_->attributes.vertex_count(); ++v)
    for (int c = 0; c < 3; ++c)
      x.set(v, c, x.get(v, c) + scale * shape[v][static_cast<std::size_t>(c)]);
  impl_->forget_forces();
  impl_->ledger.forget_last();
  impl_->ledger.after_jump(impl_->now());
}

void Dynamics::invalidate() {
  impl_->forget_forces();
  impl_->ledger.restart();
}

Index Dynamics::skip_still_cells() {
  return impl_->forces.skip_still(impl_->constraints.still(impl_->attributes.vertex_count()));
}

void Dynamics::set_damping(double alpha) {
  impl_->options.damping = alpha;
  impl_->ledger.sums.count_damping(alpha != 0);
}
double Dynamics::damping() const { return impl_->options.damping; }

double Dynamics::settled_after() const {
  return std::max({impl_->options.gravity_ramp.to, impl_->loads.settled_after(),
                   impl_->constraints.settled_after()});
}

}  // namespace suture
