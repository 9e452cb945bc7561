// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "kernel/dynamics/integrator.hpp"
#include "kernel/dynamics/ledger.hpp"

namespace suture {

struct DynamicsOptions {
  std::string integrator = "symplectic-euler";  ///< one of integrator_names()
  double damping = 0;                           ///< alpha, 1/s: f = -alpha m v
};

/// A body through time: steps of an integrator, what they exchange (the ledger), and operations
/// that come between them.
///
/// After a step the columns are those of time(), constrained components exactly
/// where they are prescribed; only Verlet's velocity waits for synchronise().
class Dynamics : private Follower {
 public:
  /// Follows the body's operations from now on. Throws InputError for an unknown integrator.
  Dynamics(Body& body, const DynamicsOptions& options);

  Body& body() const { return motion_.body(); }
  /// Where in time it is, its damping, and passes over its vertices.
  Motion& motion() { return motion_; }
  const Motion& motion() const { return motion_; }
  double time() const { return motion_.time(); }

  /// Puts constrained vertices where they are at `time`; the ledger begins. Also after positions,
  /// velocities or masses were changed by others. Throws InputError if a vertex has no mass.
  void start(double time = 0);

  /// One step to `end` (= time() + dt but for rounding, which the caller's clock
  /// avoids). Throws NumericalError for a failing model (StepRejected: nothing has moved), and
  /// for a velocity that is not finite, naming the vertex. O(cells + vertices).
  void step(double dt, double end);

  /// Velocities at time(), and, if `with_forces`, in the column `force` what the terms (not
  /// gravity) give there: before a frame or a cut. The next step gives the same bits whether or
  /// not this was called. The velocities alone cost nothing with symplectic Euler.
  void synchronise(bool with_forces = true);

  /// sum m v^2 / 2 of velocities at the time of the positions, J; changes no bit of what follows.
  double kinetic();
  /// The ledger of the run (ledger.hpp); the first call after start() is its beginning. Costs
  /// an evaluation of energies, and changes no bit of what follows.
  EnergyBalance balance();

  /// Calls `change`, which moves vertices or changes their velocities; what energy that takes is
  /// booked as an event. `keeps_forces`: those evaluated are still good.
  void jump(const std::function<void()>& change, bool keeps_forces = false);

  /// Motion, ledger and body: a state to go back to (StateBuffer), until an operation or sleep,
  /// or of a checkpoint. What follows has the same bits again, but for functors that read
  /// velocities in a synchronised state of Verlet that was gone back to: they see the velocity
  /// after its last half kick.
  void state(Archive& archive);

 private:
  void before(const ComingOperation& operation) override;
  void follow(const CellComplex& complex, const TopologyChange& change) override;
  Ledger::Now now();
  double unseen_work();
  void forget_last();
  std::vector<Vec3> accelerations_at(std::span<const Index> vertices);
  void kick_changed(const TopologyChange& change);

  Motion motion_;
  std::unique_ptr<Integrator> integrator_;
  Ledger ledger_;
  /// A vertex of an operation that is being made, and its acceleration before.
  struct Changing {
    Index vertex;
    Vec3 acceleration;
  };
  std::vector<Changing> changing_;
};

struct Energies {
  double kinetic = 0, elastic = 0;
  double external = 0;  ///< potential of gravity and dead loads, 0 at rest positions
  double total() const { return kinetic + elastic + external; }
};
/// At time(). Fixed order of summation.
Energies energies(Dynamics& dynamics);

}  // namespace suture
