// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/dynamics.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "kernel/dynamics/changed_vertices.hpp"
#include "kernel/dynamics/loops/dispatch.hpp"
#include "kernel/dynamics/step_search.hpp"

namespace suture {
namespace {

constexpr Index pass_chunk = MotionSums::chunk;
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

}  // namespace

struct Dynamics::Impl {
  Impl(Attributes& a, const CellComplex& c, const DynamicsOptions& o)
      : attributes(a),
        complex(&c),
        options(o),
        loops(hot_loops()),
        forces(a, c, o.threads),
        step_search(forces, a),
        gravity{o.gravity, o.gravity_ramp},
        ledger(a, forces, loads, constraints, gravity) {
    ledger.sums.count_damping(o.damping != 0);
  }

  // ---- forces ----

  /// The column `force` holds those of (x, v, time), for a step of dt.
  void evaluate(double dt) {
    if (evaluated && evaluated_dt == dt) return;
    if (evaluated) clear_forces();
    evaluated = false;
    try {
      ledger.add_forces(time, dt, last_dt, moving());
    } catch (...) {
      clear_forces();  // passes rely on zeros; the state before the step is whole
      throw;
    }
    evaluated = true;
    evaluated_dt = dt;
  }

  void clear_forces() {
    double* rows = attributes.force().rows();
    if (!asleep) std::fill_n(rows, std::size_t{attributes.vertex_count()} * 4, 0.0);
    for (Index v = 0; asleep && v < attributes.vertex_count(); ++v)  // sleepers keep theirs
      if (awake[v]) std::fill_n(rows + std::size_t{v} * 4, 4, 0.0);
  }

  /// The state is another: the forces must be evaluated there.
  void forget_forces() {
    if (evaluated) clear_forces();  // else they are zero already
    evaluated = false;
    old_position.clear();
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
    std::ranges::copy(gravity.at(time), m.gravity);
    m.decay[0] = m.decay[1] = 1;
    m.live = moving().data();
    return m;
  }

  static void set(loops::Motion& m, int i, const Kick& kick) {
    m.decay[i] = kick.decay;
    m.gain[i] = kick.gain;
  }

  /// chunk(number, first vertex, end) for all vertices; true if each returned true.
  template <class Chunk>
  bool for_each_chunk(Chunk chunk) {
    const Index vertices = attributes.vertex_count();
    std::atomic<bool> good{true};
    const auto one = [&](std::size_t part) {
      const Index first = static_cast<Index>(part) * pass_chunk;
      if (!chunk(part, first, std::min(first + pass_chunk, vertices))) good = false;
    };
    if (vertices >= parallel_vertices)
      forces.workers().parallel_for(parts(vertices, pass_chunk), one);
    else
      for (Index part = 0; part < parts(vertices, pass_chunk); ++part) one(part);
    return good;
  }

  /// A step whose kicks are k[0] and, of Verlet, k[1]; then the drift, and what is held is put
  /// where it is at `end`.
  void advance(double dt, double end, const Kick* kicks, int count) {
    loops::Motion m = motion();
    for (int i = 0; i < count; ++i) set(m, i, kicks[i]);
    m.drift = dt;
    const auto pass = count == 2 ? loops.kick_kick_drift : loops.kick_drift;
    const double before = last_dt != 0 ? last_dt : dt, unseen = is_lagging() ? before : 0;
    const Vec3 g = gravity.at(time);
    evaluated = false;
    const bool good = for_each_chunk([&](std::size_t part, Index first, Index last) {
      loops::PassSums sums;
      constraints.before_drift(attributes, g, first, last);
      if (pass(&m, first, last, &sums) != 0) return false;
      constraints.apply(attributes, end, first, last);
      const DrivenWork driven = constraints.after_drift(attributes, unseen, dt, first, last, sums);
      if (unseen > 0) ledger.sums.note_before(part, sums, {});
      ledger.sums.note_after(part, sums, driven);
      return true;
    });
    if (!good) refuse_not_finite();
    ledger.sums.finish_step(before, dt);
    ledger.step_made();
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
    throw NotFinite("the velocity of vertex " + std::to_string(vertex) + " is not finite",
                    shown(complex->dart_of(0, vertex) / 24));
  }

  Index shown(Index element) const {
    return attributes.user_element.empty() ? element : attributes.user_element[element];
  }

  // ---- schemes ----

  /// The velocities are those of half a step before the positions: always with symplectic
  /// Euler, and between the steps of Verlet.
  bool is_lagging() const {
    return options.scheme == DynamicsOptions::Scheme::symplectic_euler ? last_dt != 0 : is_pending;
  }

  void step(double dt, double end) {
    // Also the first one, but for that of symplectic Euler, whose kick is whole.
    const bool is_euler = options.scheme == DynamicsOptions::Scheme::symplectic_euler;
    if (!(std::abs(dt - last_dt) <= 1e-9 * dt) && !(is_euler && last_dt == 0)) {
      evaluate(last_dt != 0 ? last_dt : dt);
      ledger.change_step(leapfrog_part(dt, {}) - leapfrog_part(last_dt, {}));
    }
    if (options.scheme == DynamicsOptions::Scheme::symplectic_euler)
      step_euler(dt, end);
    else
      step_verlet(dt, end);
    last_dt = dt;
  }

  /// The velocities live in the middle of the steps, so that a kick goes from the middle of
  /// one to the middle of the next.
  void step_euler(double dt, double end) {
    evaluate(dt);
    const Kick kick(options.damping, last_dt != 0 ? (last_dt + dt) / 2 : dt);
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
    const Vec3 g = gravity.at(time);
    const bool good = for_each_chunk([&](std::size_t part, Index first, Index last) {
      loops::PassSums sums;
      constraints.before_kick(attributes, first, last);
      if (loops.kick(&m, first, last, &sums) != 0) return false;
      constraints.apply(attributes, time, first, last);
      const DrivenWork driven = constraints.after_kick(attributes, g, last_dt, first, last, sums);
      ledger.sums.note_before(part, sums, driven);
      return true;
    });
    if (!good) refuse_not_finite();
    is_pending = false;
  }

  // ---- energies ----

  /// What the velocities lack to be those of the positions' time.
  Kick lacking() const {
    if (!is_lagging()) return {};
    return is_pending ? pending : Kick(options.damping, last_dt / 2);
  }

  /// Of the velocities that `lacking()` would make.
  double kinetic() {
    evaluate(last_dt);
    return kinetic(lacking());
  }

  /// h^2/8 sum F^2/m over what is free, forces being evaluated: what leapfrog's energy
  /// sum m v- . v+ / 2 lacks of that of the mean velocity. By a second difference of `kinetic`.
  double leapfrog_part(double h, Kick at) {
    if (h == 0) return 0;
    Kick later = at, sooner = at;
    later.gain += h / 2;
    sooner.gain -= h / 2;
    return std::max(0.0, (kinetic(later) + kinetic(sooner) - 2 * kinetic(at)) / 2);
  }

  double kinetic(const Kick& kick) {
    loops::Motion m = motion();
    set(m, 0, kick);
    double sum = 0;
    for (Index begin = 0; begin < attributes.vertex_count(); begin += sum_chunk)
      sum += loops.kinetic(&m, attributes.fixed().rows(), begin,
                           std::min(begin + sum_chunk, attributes.vertex_count()));
    return sum;
  }

  /// sum m a . v- over what is free, h-/2 times: of the half step that no pass has seen.
  double unseen_work() {
    if (!is_lagging()) return last_dt * ledger.sums.noted_before() / 2;
    loops::Motion m = motion();
    double sum = 0;
    for (Index begin = 0; begin < attributes.vertex_count(); begin += pass_chunk) {
      loops::PassSums sums;
      loops.kick(&m, begin, std::min(begin + pass_chunk, attributes.vertex_count()), &sums);
      sum += sums.before;
    }
    return last_dt * sum / 2;
  }

  Ledger::Now now() {
    Ledger::Now n;
    n.kinetic = kinetic();  // evaluates the forces
    n.leapfrog_part = leapfrog_part(last_dt, lacking());
    n.time = time;
    n.half_step = is_lagging() ? last_dt : 0;
    if (ledger.needs_work()) n.work = unseen_work();
    return n;
  }

  /// A vertex of an operation that is being made, and its acceleration before.
  struct Changing {
    Index vertex;
    Vec3 acceleration;
  };
  std::vector<Vec3> forces_at(std::span<const Index> vertices);
  Vec3 over_mass(const Vec3& force, Index vertex) const;
  void kick_changed(const TopologyChange& change);

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
  Gravity gravity;
  Ledger ledger;

  double time = 0, last_dt = 0;
  bool evaluated = false;  // the column `force` is that of the present state
  double evaluated_dt = 0;
  Kick pending;  // Verlet: the half kick that the velocities lack
  bool is_pending = false;
  std::vector<Changing> changing;
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
  impl_->ledger.before_jump(impl_->now());
  impl_->asleep = true;
  impl_->forces.sleep(elements);
  for (const Index v : impl_->vertices_of(elements)) {
    impl_->awake.kill(v, impl_->attributes.vertex_count());
    for (int c = 0; c < 3; ++c) impl_->attributes.velocity().set(v, c, 0);
  }
  impl_->ledger.forget_last();
  impl_->ledger.after_jump(impl_->now());
}

void Dynamics::wake_all() { impl_->wake(); }
bool Dynamics::sleeps() const { return impl_->asleep; }

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

// ------------------------------------------------------------------- checks --

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

// -------------------------------------------------------------------- steps back --

struct Dynamics::Snapshot::State {
  double time = 0, last_dt = 0;
  Kick pending;
  bool is_pending = false;
  std::vector<double> motion;   ///< x and v, six doubles per vertex
  std::vector<double> columns;  ///< states of the models
  Ledger::State ledger;
};

Dynamics::Snapshot::Snapshot() = default;
Dynamics::Snapshot::Snapshot(Snapshot&&) noexcept = default;
Dynamics::Snapshot& Dynamics::Snapshot::operator=(Snapshot&&) noexcept = default;
Dynamics::Snapshot::~Snapshot() = default;
double Dynamics::Snapshot::time() const { return state_->time; }

void Dynamics::save(Snapshot& snapshot) const {
  if (!snapshot.state_) snapshot.state_ = std::make_unique<Snapshot::State>();
  Snapshot::State& s = *snapshot.state_;
  s.time = impl_->time;
  s.last_dt = impl_->last_dt;
  s.pending = impl_->pending;
  s.is_pending = impl_->is_pending;
  const Index vertices = impl_->attributes.vertex_count();
  const double *x = impl_->attributes.position().rows(), *v = impl_->attributes.velocity().rows();
  s.motion.resize(std::size_t{vertices} * 6);
  double* out = s.motion.data();
  for (Index i = 0; i < vertices; ++i, x += 4, v += 4, out += 6)
    out[0] = x[0], out[1] = x[1], out[2] = x[2], out[3] = v[0], out[4] = v[1], out[5] = v[2];
  s.columns.clear();
  impl_->attributes.save_states(s.columns);
  s.ledger = impl_->ledger.save();
}

void Dynamics::restore(const Snapshot& snapshot) {
  const Snapshot::State& s = *snapshot.state_;
  const Index vertices = impl_->attributes.vertex_count();
  if (s.motion.size() != std::size_t{vertices} * 6)
    throw std::logic_error("a snapshot of other vertices");
  impl_->forget_forces();
  impl_->clear_forces();  // a pass that failed has left some
  impl_->time = s.time;
  impl_->last_dt = s.last_dt;
  impl_->pending = s.pending;
  impl_->is_pending = s.is_pending;
  double *x = impl_->attributes.position().rows(), *v = impl_->attributes.velocity().rows();
  const double* in = s.motion.data();
  for (Index i = 0; i < vertices; ++i, x += 4, v += 4, in += 6)
    x[0] = in[0], x[1] = in[1], x[2] = in[2], v[0] = in[3], v[1] = in[4], v[2] = in[5];
  impl_->attributes.restore_states(s.columns);
  impl_->ledger.restore(s.ledger);
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

double Dynamics::settled_after() const {
  return std::max({impl_->options.gravity_ramp.to, impl_->loads.settled_after(),
                   impl_->constraints.settled_after()});
}

}  // namespace suture
