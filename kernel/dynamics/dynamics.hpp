// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "kernel/dynamics/constraints.hpp"
#include "kernel/dynamics/ledger.hpp"
#include "kernel/forces/force_loop.hpp"
#include "kernel/forces/loads.hpp"
#include "kernel/forces/loops/loops.hpp"

namespace suture {

/// A velocity is infinite or no number.
class NotFinite : public NumericalError {
 public:
  using NumericalError::NumericalError;
};

/// What moves and how.
struct DynamicsOptions {
  enum class Scheme { symplectic_euler, velocity_verlet };
  Scheme scheme = Scheme::symplectic_euler;
  double damping = 0;  ///< alpha, 1/s: f = -alpha m v
  Vec3 gravity{};      ///< m/s^2
  TimeRamp gravity_ramp;
  unsigned threads = 0;  ///< 0: as many as pay
};

/// Positions and velocities through time: forces, loads, gravity, damping,
/// constraints and the integrator, on the columns of `attributes`.
///
/// With a = f/m + g and h = dt, and damping integrated exactly (stable for any
/// alpha h, of second order in Verlet's splitting): e = exp(-alpha h),
///   symplectic Euler   v' = e v + (1 - e)/alpha a(x, v),   x' = x + h v'
///                      (where h changes, the kick spans half of either step)
///   velocity Verlet    half a kick, x' = x + h v, half a kick with a(x')
/// Verlet's second half kick is left to the next step, where both are made in one
/// pass over the vertices; synchronise() makes it at once, with the same rounding.
/// So there is one evaluation of forces per step in both. Viscous forces see the
/// velocity half a step before the positions (Verlet): first order in dt.
///
/// After a step the columns are those of time(), constrained components exactly
/// where they are prescribed; only Verlet's velocity waits for synchronise().
class Dynamics {
 public:
  Dynamics(Attributes& attributes, const CellComplex& complex, const DynamicsOptions& options);
  ~Dynamics();

  // Before start().
  Constraints& constraints();
  Loads& loads();
  ForceLoop& forces();
  const ForceLoop& forces() const;

  /// Puts constrained vertices where they are at `time`. Throws InputError if a
  /// vertex has no mass.
  void start(double time = 0);

  /// One step to `end` (= time() + dt but for rounding, which the caller's clock
  /// avoids). Throws NumericalError for a failing model, and for a velocity that
  /// is not finite, naming the vertex. O(cells + vertices).
  void step(double dt, double end);
  double time() const;

  /// Velocities at time(), and in the column `force` what the models and loads
  /// (not gravity) give there: before a frame, a cut, or energies. The next step
  /// gives the same bits whether or not this was called.
  void synchronise();

  /// The velocities alone, where the forces are not wanted. Costs nothing with symplectic Euler.
  void synchronise_velocities();

  /// Before an operation on these vertices, each given once: remembers their accelerations, as
  /// half a step is still owed to the velocities with the forces before the operation and not
  /// with those after it. O(cells around them). If elements are going to be removed or joined
  /// (`only_apart` false), what energy that takes is booked, for two evaluations.
  void prepare_change(std::span<const Index> vertices, bool only_apart);

  /// An operation was made and attributes.apply() called. Call prepare_change()
  /// before the operation. Wakes all that sleeps. O(cells touched + loaded).
  void update(const CellComplex& complex, const TopologyChange& change);
  /// Moves each vertex by `scale` times its row of `shape`, m; what energy that takes is booked
  /// as an event.
  void displace(std::span<const Vec3> shape, double scale);
  /// Positions, velocities or masses were changed by others: the ledger starts again.
  void invalidate();

  /// Cells between vertices that are held at rest for good are left out from now
  /// on (ForceLoop::skip_still); returns how many. After the constraints are added.
  Index skip_still_cells();

  /// How far a set of elements is from rest, over its vertices and free components,
  /// with all forces, loads and gravity. Synchronises. O(elements).
  struct Stillness {
    double residual = 0;      ///< sqrt(sum |f|^2), N
    double acceleration = 0;  ///< largest |f| / m, m/s^2
    double velocity = 0;      ///< largest, m/s
  };
  Stillness stillness(std::span<const Index> elements);

  /// Islands that are still may sleep: their vertices are frozen with velocity zero,
  /// their cells are not computed. They wake at the next update() or wake_all(); wake
  /// them too before a load, gravity or a motion of theirs changes (settled_after()).
  /// `elements`: whole islands, or InputError. O(elements).
  ///
  /// What is lost: with acceleration a and velocity v from stillness(), while the forces
  /// are linear in the displacements and K >= 0, each mode obeys u'' = a_i - w_i^2 u, so
  /// that the motion omitted in a sleep of length T is, in the root mean square weighed
  /// by mass, at most
  ///     v T + a T^2 / 2   and   v / w + 2 a / w^2
  /// w being the lowest angular frequency of the island as it is held (0 if it is free,
  /// so that only the first bound holds).
  void sleep(std::span<const Index> elements);
  void wake_all();
  bool sleeps() const;

  void set_damping(double alpha);
  double damping() const;

  struct Energies {
    double kinetic = 0, elastic = 0;
    double external = 0;  ///< potential of gravity and dead loads, 0 at rest positions
    double total() const { return kinetic + elastic + external; }
  };
  /// At time(), of velocities at the time of the positions; changes no bit of what follows.
  /// Fixed order of summation.
  Energies energies();

  /// The ledger of the run (ledger.hpp); the first call after start() is its beginning. Costs
  /// an evaluation of energies, and changes no bit of what follows.
  EnergyBalance balance();

  /// h w of the motion of the last step, w being its apparent frequency where that is largest
  /// (motion_sums.hpp): 2 where the step is unstable. Free of cost; 0 where rounding prevails.
  double apparent_frequency() const;
  /// The vertex with the most kinetic energy there.
  Index fastest_vertex() const;

  /// A state to go back to; 48 B per vertex and the states of the models. Good until an operation,
  /// sleep or wake_all(). What follows has the same bits again, but for functors that read
  /// velocities in a synchronised state of Verlet: they see the velocity after its last half kick.
  class Snapshot {
   public:
    Snapshot();
    Snapshot(Snapshot&&) noexcept;
    Snapshot& operator=(Snapshot&&) noexcept;
    ~Snapshot();
    double time() const;

   private:
    friend class Dynamics;
    struct State;
    std::unique_ptr<State> state_;
  };
  void save(Snapshot& snapshot) const;
  void restore(const Snapshot& snapshot);

  /// What the rounding of positions amounts to: the last step moved each vertex by
  /// eps |x|, against a stiffness of at most m (2/dt)^2. Energies of that size, times
  /// the steps made, are noise, and so are forces.
  struct Rounding {
    double energy = 0;         ///< J, of a step
    double force_squared = 0;  ///< N^2, summed over the vertices
  };
  Rounding rounding() const;

  /// The largest stable step of the present state, s; infinite without forces. From
  /// the tangent (step_search.hpp) if every functor has one, else from bounds().
  /// Throws PluginError for a functor that offers neither. `from_random`: the search forgets
  /// the mode that it found last, and overlooks none.
  double stable_step(bool from_random = false);
  /// Bounds per vertex on the safe side, cell by cell: for springs and blocks the step
  /// is 0.6 to 0.75 of stable_step(). See stable_step.hpp.
  ForceLoop::Bounds bounds();
  /// bounds() of the vertices that operations changed since the last call, and of no
  /// others: the step stays stable below both the stable step before and this one.
  /// O(cells changed).
  ForceLoop::Bounds bounds_of_changes();

  /// Elements with a corner Jacobian <= 0, ascending. O(elements), far below an evaluation
  /// of forces.
  std::vector<Index> inverted_elements() const;

  /// Sums for the search of rest (rest_search.hpp) at the present state; evaluates
  /// forces that the next step uses.
  loops::RestSums rest_sums();
  /// When the last ramp of gravity, loads and motions ends, s.
  double settled_after() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace suture
