// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/dynamics.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <string>

#include "kernel/dynamics/changed_vertices.hpp"
#include "kernel/dynamics/loops/dispatch.hpp"
#include "kernel/dynamics/step_search.hpp"

namespace suture {
namespace {

constexpr Index pass_chunk = 1024;  // vertices: 0.1 MB of columns, 5 us
/// Below, one thread is as fast. A pass between two parallel loops pays early, because
/// threads that wait through it fall asleep.
constexpr Index parallel_vertices = 8192;
constexpr Index sum_chunk = 4096;

/// Number of ranges of `size` that hold `count`.
Index parts(Index count, Index size) { return (count + size - 1) / size; }

/// Kick over h with damping alpha: v' = decay v + gain a, exact for constant a.
///   decay = exp(-alpha h),  gain = (1 - decay) / alpha,  h without damping
struct Kick {
  double decay = 1, gain = 0;
  Kick() = default;
  Kick(double alpha, double h) : gain(h) {
    if (alpha == 0) return;
    decay = std::exp(-alpha * h);
    gain = -std::expm1(-alpha * h) / alpha;
  }
};

std::string at_time(double time) { return "at t = " + std::to_string(time) + " s"; }

}  // namespace

struct Dynamics::Impl {
  Impl(Attributes& a, const CellComplex& c, const DynamicsOptions& o)
      : attributes(a),
        complex(&c),
        options(o),
        loops(hot_loops()),
        forces(a, c, o.threads),
        step_search(forces, a) {}

  // ---- forces ----

  /// The column `force` holds those of (x, v, time), for a step of dt.
  void evaluate(double dt) {
    if (evaluated && evaluated_dt == dt) return;
    if (evaluated) clear_forces();
    evaluated = false;
    try {
      forces.add_forces(time, dt);
    } catch (...) {
      clear_forces();  // passes rely on zeros; the state before the step is whole
      throw;
    }
    loads.add_to(attributes.force().rows(), attributes.position().rows(), time, moving());
    evaluated = true;
    evaluated_dt = dt;
  }

  void clear_forces() {
    double* rows = attributes.force().rows();
    if (!asleep) std::fill_n(rows, std::size_t{attributes.vertex_count()} * 4, 0.0);
    for (Index v = 0; asleep && v < attributes.vertex_count(); ++v)  // sleepers keep theirs
      if (awake[v]) std::fill_n(rows + std::size_t{v} * 4, 4, 0.0);
  }

  /// Vertices that are there and awake.
  const LiveMask& moving() const { return asleep ? awake : attributes.kernel(0).cells.live(); }

  void wake() {
    if (!asleep) return;
    asleep = false;
    forces.wake_all();
    clear_forces();
    evaluated = false;
  }

  // ---- passes ----

  loops::Motion motion() {
    loops::Motion m{};
    m.position = attributes.position().rows();
    m.velocity = attributes.velocity().rows();
    m.force = attributes.force().rows();
    m.mass = attributes.mass().rows();
    const double ramp = options.gravity_ramp.value(time);
    for (std::size_t c = 0; c < 3; ++c) m.gravity[c] = ramp * options.gravity[c];
    m.live = moving().data();
    return m;
  }

  static void set(loops::Motion& m, int i, const Kick& kick) {
    m.decay[i] = kick.decay;
    m.gain[i] = kick.gain;
  }

  /// `pass`, and the vertices that are held put where they are at `end`.
  template <class Pass>
  void run(const loops::Motion& m, Pass pass, double end) {
    const Index vertices = attributes.vertex_count();
    std::atomic<bool> broken{false};
    const auto one = [&](std::size_t part) {
      const Index first = static_cast<Index>(part) * pass_chunk;
      const Index last = std::min(first + pass_chunk, vertices);
      if (pass(&m, first, last) == 0)
        constraints.apply(attributes, end, first, last);
      else
        broken = true;
    };
    if (vertices >= parallel_vertices)
      forces.workers().parallel_for(parts(vertices, pass_chunk), one);
    else
      for (Index part = 0; part < parts(vertices, pass_chunk); ++part) one(part);
    if (broken) refuse_not_finite();
  }

  /// A step whose kicks are k[0] and, of Verlet, k[1]; then the drift.
  void advance(double dt, double end, const Kick* kicks, int count) {
    loops::Motion m = motion();
    for (int i = 0; i < count; ++i) set(m, i, kicks[i]);
    m.drift = dt;
    evaluated = false;
    run(m, count == 2 ? loops.kick_kick_drift : loops.kick_drift, end);
    time = end;
    forces.accept();
  }

  [[noreturn]] void refuse_not_finite() const {
    const double* v = attributes.velocity().rows();
    Index vertex = 0;
    const auto finite = [&](Index i) {
      return std::isfinite(v[4 * std::size_t{i}]) && std::isfinite(v[4 * std::size_t{i} + 1]) &&
             std::isfinite(v[4 * std::size_t{i} + 2]);
    };
    while (vertex + 1 < attributes.vertex_count() && finite(vertex)) ++vertex;
    const Index element = complex->dart_of(0, vertex) / 24;
    throw NumericalError(at_time(time) + ": the velocity of vertex " + std::to_string(vertex) +
                         " (element " + std::to_string(shown(element)) +
                         ") is no finite number; use a smaller \"dt\", or \"auto\"");
  }

  Index shown(Index element) const {
    return attributes.user_element.empty() ? element : attributes.user_element[element];
  }

  // ---- schemes ----

  void step(double dt, double end) {
    if (options.scheme == DynamicsOptions::Scheme::symplectic_euler)
      step_euler(dt, end);
    else
      step_verlet(dt, end);
    last_dt = dt;
  }

  void step_euler(double dt, double end) {
    evaluate(dt);
    const Kick kick(options.damping, dt);
    advance(dt, end, &kick, 1);
  }

  /// The forces are those at the end of the step before, so its dt is theirs: they
  /// must not be computed again when the velocities have had their half kick.
  void step_verlet(double dt, double end) {
    evaluate(last_dt != 0 ? last_dt : dt);
    const Kick half(options.damping, dt / 2);
    const Kick kicks[2] = {pending, half};
    if (is_pending)
      advance(dt, end, kicks, 2);
    else
      advance(dt, end, &half, 1);
    pending = half;
    is_pending = true;
  }

  void synchronise() {
    evaluate(last_dt);
    if (!is_pending) return;
    loops::Motion m = motion();
    set(m, 0, pending);
    run(m, loops.kick, time);
    is_pending = false;
  }

  double external_potential() const;
  loops::RestSums rest_sums();
  std::vector<Index> vertices_of(std::span<const Index> elements) const;
  void require_islands(std::span<const Index> elements) const;
  Vec3 total_force(Index vertex) const;

  Attributes& attributes;
  const CellComplex* complex;
  DynamicsOptions options;
  const loops::Table& loops;
  ForceLoop forces;
  StepSearch step_search;
  ChangedVertices changed;  ///< since bounds_of_changes()
  Constraints constraints;
  Loads loads;

  double time = 0, last_dt = 0;
  bool evaluated = false;  // the column `force` is that of the present state
  double evaluated_dt = 0;
  Kick pending;  // Verlet: the half kick that the velocities lack
  bool is_pending = false;
  bool asleep = false;                                      // some island is
  LiveMask awake;                                           // vertices, while something sleeps
  AlignedVector<double> old_position, old_force, external;  // of rest_sums()
};

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
  invalidate();
  impl_->constraints.apply(impl_->attributes, time);
}

void Dynamics::step(double dt, double end) { impl_->step(dt, end); }
void Dynamics::synchronise() { impl_->synchronise(); }
void Dynamics::synchronise_velocities() {
  if (impl_->is_pending) impl_->synchronise();
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
  invalidate();
}

// -------------------------------------------------------------------- sleep --

std::vector<Index> Dynamics::Impl::vertices_of(std::span<const Index> elements) const {
  std::vector<Index> vertices;
  for (const Index e : elements) {
    const Hexahedron& nodes = complex->vertices_of(e);
    vertices.insert(vertices.end(), nodes.begin(), nodes.end());
  }
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

void Dynamics::Impl::require_islands(std::span<const Index> elements) const {
  std::vector<bool> inside(complex->element_count());
  for (const Index e : elements) {
    if (e >= complex->element_count() || !complex->exists(3, e))
      throw InputError("element " + std::to_string(e) + " cannot sleep: there is none");
    inside[e] = true;
  }
  for (const Index e : elements)
    for (int f = 0; f < 6; ++f) {
      const Index other = complex->neighbour(e, f);
      if (other != none && !inside[other])
        throw InputError("element " + std::to_string(shown(e)) +
                         " cannot sleep alone: it hangs together with element " +
                         std::to_string(shown(other)) + "; put whole islands to sleep");
    }
}

/// Of the models, the loads and gravity, in the free components.
Vec3 Dynamics::Impl::total_force(Index vertex) const {
  const int bits = static_cast<int>(attributes.fixed().get(vertex, 0));
  const double weight = options.gravity_ramp.value(time) * attributes.mass().get(vertex, 0);
  Vec3 f{};
  for (int c = 0; c < 3; ++c)
    if ((bits >> c & 1) == 0)
      f[static_cast<std::size_t>(c)] =
          attributes.force().get(vertex, c) + weight * options.gravity[static_cast<std::size_t>(c)];
  return f;
}

Dynamics::Stillness Dynamics::stillness(std::span<const Index> elements) {
  synchronise();
  Stillness result;
  double squares = 0;
  for (const Index v : impl_->vertices_of(elements)) {
    const Vec3 f = impl_->total_force(v);
    const double force = std::hypot(f[0], f[1], f[2]);
    squares += force * force;
    const Column& velocity = impl_->attributes.velocity();
    const double speed = std::hypot(velocity.get(v, 0), velocity.get(v, 1), velocity.get(v, 2));
    result.acceleration = std::max(result.acceleration, force / impl_->attributes.mass().get(v, 0));
    result.velocity = std::max(result.velocity, speed);
  }
  result.residual = std::sqrt(squares);
  return result;
}

void Dynamics::sleep(std::span<const Index> elements) {
  if (elements.empty()) return;
  impl_->require_islands(elements);
  synchronise();  // what sleeps keeps the forces of this state
  if (!impl_->asleep) impl_->awake = impl_->attributes.kernel(0).cells.live();
  impl_->asleep = true;
  impl_->forces.sleep(elements);
  for (const Index v : impl_->vertices_of(elements)) {
    impl_->awake.kill(v, impl_->attributes.vertex_count());
    for (int c = 0; c < 3; ++c) impl_->attributes.velocity().set(v, c, 0);
  }
}

void Dynamics::wake_all() { impl_->wake(); }
bool Dynamics::sleeps() const { return impl_->asleep; }

void Dynamics::invalidate() {
  if (impl_->evaluated) impl_->clear_forces();  // else they are zero already
  impl_->evaluated = false;
  impl_->old_position.clear();
}

Index Dynamics::skip_still_cells() {
  return impl_->forces.skip_still(impl_->constraints.still(impl_->attributes.vertex_count()));
}

void Dynamics::set_damping(double alpha) { impl_->options.damping = alpha; }
double Dynamics::damping() const { return impl_->options.damping; }

// ------------------------------------------------------------------- checks --

double Dynamics::kinetic_energy() const {
  const Index vertices = impl_->attributes.vertex_count();
  double sum = 0;
  for (Index begin = 0; begin < vertices; begin += sum_chunk)
    sum +=
        impl_->loops.kinetic(impl_->attributes.velocity().rows(), impl_->attributes.mass().rows(),
                             begin, std::min(begin + sum_chunk, vertices));
  return sum;
}

Dynamics::Rounding Dynamics::rounding() const {
  if (impl_->last_dt == 0) return {};
  const Column &position = impl_->attributes.position(), &mass = impl_->attributes.mass();
  const double omega = 2 / impl_->last_dt, epsilon = std::numeric_limits<double>::epsilon();
  Rounding sum;
  for (Index v = 0; v < impl_->attributes.vertex_count(); ++v) {
    const double at = std::hypot(position.get(v, 0), position.get(v, 1), position.get(v, 2));
    const double force = mass.get(v, 0) * omega * omega * epsilon * at;
    sum.energy += force * epsilon * at / 2;
    sum.force_squared += force * force;
  }
  return sum;
}

double Dynamics::most_given(double length) const {
  const Index vertices = impl_->attributes.vertex_count();
  const Column& mass = impl_->attributes.mass();
  std::vector<double> force(4 * std::size_t{vertices});
  impl_->loads.add_to(force.data(), impl_->attributes.position().rows(), impl_->time);
  const double ramp = impl_->options.gravity_ramp.value(impl_->time);
  for (Index v = 0; v < vertices; ++v)
    for (std::size_t c = 0; c < 3; ++c)
      force[4 * std::size_t{v} + c] += ramp * mass.get(v, 0) * impl_->options.gravity[c];
  double sum = 0;
  for (Index v = 0; v < vertices; ++v) {
    if (!(mass.get(v, 0) > 0)) continue;
    const double* f = &force[4 * std::size_t{v}];
    const double size = std::hypot(f[0], f[1], f[2]), momentum = size * impl_->time;
    sum += std::min(momentum * momentum / (2 * mass.get(v, 0)), size * length);
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
  synchronise();
  return {kinetic_energy(), impl_->forces.energy(impl_->time), impl_->external_potential()};
}

double Dynamics::stable_step() {
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

Dynamics::Inversions Dynamics::inversions() const {
  const Index elements = impl_->complex->element_count();
  const Index* nodes = impl_->complex->vertices().data()->data();
  const std::uint8_t* live = impl_->attributes.kernel(3).cells.live().data();
  const auto& users = impl_->attributes.user_element;
  Inversions found;
  for (Index begin = 0; begin < elements; begin += sum_chunk) {
    Index first = none;
    const Index end = std::min(begin + sum_chunk, elements);
    const Index here =
        impl_->loops.inverted(nodes, live, impl_->attributes.position().rows(), begin, end, &first);
    if (here == 0) continue;
    found.count += here;
    // Users' numbers are in another order: look at each element of the chunk.
    for (Index e = first; e < end; ++e) {
      if (!users.empty() && users[e] >= found.first) continue;
      if (e == first || impl_->loops.inverted(nodes, live, impl_->attributes.position().rows(), e,
                                              e + 1, &first) != 0)
        found.first = std::min(found.first, impl_->shown(e));
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
  const double ramp = options.gravity_ramp.value(time);
  for (std::size_t c = 0; c < 3; ++c) in.gravity[c] = ramp * options.gravity[c];
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

double Dynamics::settled_after() const {
  return std::max({impl_->options.gravity_ramp.to, impl_->loads.settled_after(),
                   impl_->constraints.settled_after()});
}

}  // namespace suture
