// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernel/dynamics/motion.hpp"
#include "kernel/dynamics/step_budget.hpp"

namespace suture {

class Newton;
struct StepEquations;

/// What an explicit step makes of the state at its start:
///   v' = decay v + gain (f / m + g) where components are free,   x' = x + dt v'
struct ExplicitStep {
  Kick kick;
  double forces_dt = 0;  ///< the dt with which the forces are evaluated, s
};

/// A time integration scheme. Each has its own file; integrators.cpp lists them.
///
/// A step begins and is then either accepted or rejected before another may begin.
class Integrator {
 public:
  explicit Integrator(Motion& motion) : motion_(motion) {}
  virtual ~Integrator() = default;

  /// Performs the part of a step of length dt that a term may refuse. Throws the errors of terms
  /// (StepRejected: a smaller step may help); the previous state is intact then.
  virtual void begin(double dt) = 0;
  /// Solves the equations of the step that has begun once more, after what forces depend on beside
  /// the motion has changed; for implicit schemes. Errors as begin().
  virtual void repeat() {}
  /// Does beforehand what a step of length dt can be spared.
  virtual void prepare(double /*dt*/) {}
  /// Completes the step: positions and velocities become those at `end` (= time() + dt, except for
  /// rounding). Throws NotFinite.
  virtual void accept(double end) = 0;
  /// Discards the step as if it had not begun.
  virtual void reject() = 0;

  /// True if any step is stable. Where steps solve equations, their solver is newton().
  virtual bool is_implicit() const { return false; }
  virtual Newton* newton() { return nullptr; }
  /// False if steps are only near to what the scheme's equations say, so that these have nothing to
  /// do with their derivatives.
  virtual bool is_solved() const { return true; }
  /// The equations of a step of length dt from the current state, valid until the next call; null
  /// for explicit schemes, whose steps explicit_step() describes.
  virtual const StepEquations* equations(double /*dt*/) { return nullptr; }
  virtual ExplicitStep explicit_step(double /*dt*/) const { return {}; }
  /// The linear solver of a step of length dt, and why; for implicit schemes.
  virtual std::string describe_solver(double /*dt*/) { return {}; }
  /// The part of the stiffness that steps leave out, the mean of all so far; 0 of schemes whose
  /// stiffness does not depend on the step.
  virtual double softness() const { return 0; }
  /// Whether cells are stiffer by that part, so that a tenth of it or less is left out.
  virtual bool compensates() const { return false; }
  /// The step at which it is about this in smooth deformations from the current state, s.
  virtual double step_of_softness(double /*softness*/) { return 0; }
  /// True if nothing has a velocity: steps are equilibria.
  virtual bool is_static() const { return false; }
  /// True if the velocities lag the positions by half a step.
  virtual bool is_lagging() const { return false; }
  /// The kick that brings the velocities to the time of the positions.
  virtual Kick lacking() const { return {}; }
  /// True if a step of this length changes the times to which the velocities refer.
  virtual bool is_other_step(double dt) const;
  /// Applies the lacking kick to the velocities, if that does not affect later steps. The forces
  /// must be evaluated.
  virtual void synchronise() {}
  /// True if synchronise() has work to do.
  virtual bool waits() const { return false; }
  /// What is known of the cells is no longer true.
  virtual void forget_cells() {}
  /// An operation has changed the cells.
  virtual void follow(const TopologyChange&) { forget_cells(); }
  /// State in addition to that of the motion.
  virtual void state(Archive&) {}

 protected:
  Motion& motion_;
};

/// What implicit schemes need to know.
struct IntegratorOptions {
  double tolerance = 1e-8;  ///< of the residual, relative to the forces
  /// By instance of the body: whether an equilibrium in which its elements have become inverted is
  /// no solution. Empty: none.
  std::vector<bool> forbids_inversion{};
  bool holds_free_pieces = false;      ///< static equilibria: by inertia relief
  bool follows_path = false;           ///< static equilibria: through limit points (ArcLength)
  std::optional<StepBudget> budget{};  ///< implicit Euler: steps are not solved, but on time
  bool compensates = false;            ///< xpbd: cells are stiffer by what steps leave out
};

/// Creates an integrator by its name in scenes, for example "symplectic-euler". Throws InputError
/// for an unknown name.
std::unique_ptr<Integrator> make_integrator(const std::string& name, Motion& motion,
                                            const IntegratorOptions& options);
/// Whether any step of the scheme of this name is stable.
bool is_implicit(const std::string& name);
/// Whether it solves equations in every step, into which contact enters as a term.
bool solves_equations(const std::string& name);
/// c in the error c h^2 (a' - a) of its steps (LocalError); 0 if the scheme has no such estimate.
double error_constant(const std::string& name);
/// All names, the default first.
std::vector<std::string> integrator_names();

}  // namespace suture
