// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernel/dynamics/integrator.hpp"
#include "kernel/dynamics/ledger.hpp"

namespace suture {

struct DynamicsOptions {
  std::string integrator = "symplectic-euler";  ///< one of integrator_names()
  double damping = 0;                           ///< alpha, 1/s: f = -alpha m v
  IntegratorOptions solver{};                   ///< of implicit schemes
};

/// Advances a body in time: steps of an integrator, their energy ledger, and operations between
/// steps.
///
/// After a step, the columns refer to time(), with constrained components exactly at their
/// prescribed positions; only the velocity of Verlet needs synchronise().
class Dynamics : private Follower {
 public:
  /// Follows the body's operations from now on. Throws InputError for an unknown integrator, and
  /// for an implicit one if a functor has no tangent.
  Dynamics(Body& body, const DynamicsOptions& options);

  Body& body() const { return motion_.body(); }
  /// Its time, its damping, and the passes over its vertices.
  Motion& motion() { return motion_; }
  const Motion& motion() const { return motion_; }
  double time() const { return motion_.time(); }
  /// True if the scheme is implicit: no step is too long to be stable.
  bool is_implicit() const { return integrator_->is_implicit(); }
  /// True if the scheme finds equilibria and no motion: the energy that loads give and springs do
  /// not store is taken to be dissipated.
  bool is_static() const { return integrator_->is_static(); }
  /// Whether the balance of the energy says how good the steps are: not of equilibria, nor of
  /// implicit steps of functors that read a field, which damp what the field sets in motion.
  bool has_balance() const {
    return !is_static() && !(is_implicit() && body().models().reads_fields());
  }
  /// For an implicit scheme: the linear solver of steps of length dt and why.
  std::string describe_solver(double dt) { return integrator_->describe_solver(dt); }
  /// Makes what a first step of this length would have to make before it can begin.
  void prepare(double dt) { integrator_->prepare(dt); }
  bool is_solved() const { return integrator_->is_solved(); }  ///< Integrator::is_solved()
  /// Integrator::softness(), compensates() and step_of_softness().
  double softness() const { return integrator_->softness(); }
  bool compensates() const { return integrator_->compensates(); }
  double step_of_softness(double softness) { return integrator_->step_of_softness(softness); }
  /// The solver of an implicit scheme, or nullptr.
  Newton* newton() { return integrator_->newton(); }
  /// What a step of length dt from the current state does, without making it: the equations of an
  /// implicit scheme, valid until the next call, or null; the kick of an explicit one.
  const StepEquations* equations(double dt) { return integrator_->equations(dt); }
  ExplicitStep explicit_step(double dt) const { return integrator_->explicit_step(dt); }

  /// Moves constrained vertices to their positions at `time` and starts the ledger. Call it again
  /// after positions, velocities or masses were changed from outside. Throws InputError if a vertex
  /// has no mass.
  void start(double time = 0);

  /// Makes one step to `end` (= time() + dt, except for rounding, which the caller's clock avoids).
  /// Throws NumericalError for a failing model (StepRejected: nothing has moved, if is_whole()),
  /// and for a velocity that is not finite, naming the vertex. O(cells + vertices).
  void step(double dt, double end);
  /// False after a step that failed where it ended: the state is lost, and one that was kept must
  /// be loaded. Whether models accept the end of a position based step shows only there.
  bool is_whole() const { return is_whole_; }

  /// Brings the velocities to time() and, if `with_forces`, writes the forces of the terms (except
  /// gravity) there to the column `force`. Call it before a frame or a cut. The bits of the next
  /// step do not depend on this call. The velocities alone cost nothing with symplectic Euler.
  void synchronise(bool with_forces = true);

  /// The kick from the velocities to those at the time of the positions.
  Kick lacking() const { return integrator_->lacking(); }
  /// sum m v^2 / 2 with the velocities at the time of the positions, J; changes no bit of later
  /// steps.
  double kinetic();
  /// The ledger of the run (ledger.hpp); the first call after start() begins it. Costs an
  /// evaluation of energies, and changes no bit of later steps.
  EnergyBalance balance();
  /// The same as a check of the run: keeps the scale of the energies, and below which speed motion
  /// may be rounding. What steps and messages depend on is thus the same for any output.
  EnergyBalance check_balance();

  /// Calls `change`, which moves vertices or changes their velocities, and books the change of
  /// energy as an event. `keeps_forces`: the evaluated forces remain valid.
  void jump(const std::function<void()>& change, bool keeps_forces = false);

  /// Calls `change`, which holds vertices or frees those that it returns, ascending. What is held
  /// has its prescribed velocity from now on, what is free keeps the one that it has; the change of
  /// the energy is booked as an event.
  void constrain(const std::function<std::vector<Index>()>& change);

  /// Calls `change`, which changes forces, masses or gravity. Positions stay, and so do the
  /// velocities at their time; the change of the energy is booked as an event. Throws the errors of
  /// `change`, of terms, and InputError if a vertex has no mass; the caller then undoes the change.
  void change_forces(const std::function<void()>& change);

  /// Motion, ledger and body: a state for a rollback (StateBuffer), valid until an operation or
  /// sleep, or for a checkpoint. Later steps are bitwise identical, except for functors that read
  /// velocities after a rollback to a synchronised Verlet state: they see the velocity after its
  /// last half kick.
  void state(Archive& archive);

 private:
  void require_masses();
  void solve_fields(double dt, double end);
  double advance_fields(double dt, double end);
  void take_turns(double dt, double end);
  void fields_have_changed();
  std::vector<Vec3> accelerations();
  void before(const ComingOperation& operation) override;
  void follow(const CellComplex& complex, const TopologyChange& change) override;
  Ledger::Now now();
  double unseen_work();
  void forget_last();
  /// The forces of the terms on some vertices, which kicks and the ledger ask for in turn.
  struct ForcesAt {
    std::vector<Index> vertices;
    std::vector<Vec3> forces;
  };
  const std::vector<Vec3>& forces_at(std::span<const Index> vertices, ForcesAt& known);
  std::vector<Vec3> accelerations_at(std::span<const Index> vertices, ForcesAt& known);
  void kick_changed(const TopologyChange& change, ForcesAt& known);
  bool changes_locally(const ComingOperation& operation);
  Ledger::Part part_at(std::span<const Index> vertices, ForcesAt& known);
  void book_removal(const TopologyChange& change, ForcesAt& known);
  void follow_touched(const TopologyChange& change);
  double touched_inertia() const;

  Motion motion_;
  std::unique_ptr<Integrator> integrator_;
  Ledger ledger_;
  bool is_whole_ = true;
  /// A vertex affected by the current operation, and its previous acceleration.
  struct Changing {
    Index vertex;
    Vec3 acceleration;
    double mass;
  };
  std::vector<Changing> changing_;
  /// The vertices of the current operation, those that it has made last.
  std::vector<Index> touched_;
  bool touches_all_ = false;  ///< others may change, too
  double inertia_ = 0;        ///< touched_inertia() before it, J
  /// An operation whose jump of the energy is booked around its vertices.
  struct Removal {
    std::vector<Index> elements;  ///< around them
    Ledger::Part before;
    std::vector<double> booked;  ///< per term
  };
  std::optional<Removal> removal_;
};

struct Energies {
  double kinetic = 0, elastic = 0;
  double external = 0;  ///< potential of gravity and dead loads, 0 at rest positions
  double total() const { return kinetic + elastic + external; }
};
/// The energies at time(), summed in a fixed order.
Energies energies(Dynamics& dynamics);

}  // namespace suture
