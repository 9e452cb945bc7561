// SPDX-License-Identifier: GPL-3.0-or-later
//
// What Dynamics is made of: for its own sources only. dynamics.cpp makes steps and follows
// operations, dynamics_sleep.cpp puts islands to sleep, dynamics_looks.cpp looks at the state,
// dynamics_snapshot.cpp goes back to an earlier one.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "kernel/dynamics/changed_vertices.hpp"
#include "kernel/dynamics/dynamics.hpp"
#include "kernel/dynamics/step_search.hpp"
#include "kernel/forces/loops/dispatch.hpp"

namespace suture {

inline constexpr Index pass_chunk = MotionSums::chunk;
/// Below, one thread is as fast. A pass between two parallel loops pays early, because
/// threads that wait through it fall asleep.
inline constexpr Index parallel_vertices = 8192;
inline constexpr Index sum_chunk = 4096;

/// Number of ranges of `size` that hold `count`.
inline Index parts(Index count, Index size) { return (count + size - 1) / size; }

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
      evaluate(is_euler || last_dt == 0 ? dt : last_dt);  // as the step itself does
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

}  // namespace suture
