// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/dynamics/integrator.hpp"
#include "kernel/dynamics/residual.hpp"
#include "kernel/implicit/newton.hpp"

namespace suture {

/// A scheme whose step solves equations for the positions at its end (StepEquations). A derived
/// class gives the equations.
class ImplicitIntegrator : public Integrator {
 public:
  ImplicitIntegrator(Motion& motion, const IntegratorOptions& options);

  /// Throws StepRejected or NumericalError if the equations have no solution within reach.
  void begin(double dt) final;
  void repeat() final;
  void accept(double end) override;
  void reject() final;
  bool is_implicit() const final { return true; }
  bool is_other_step(double) const final { return false; }
  Newton* newton() final { return &newton_; }
  const StepEquations* equations(double dt) final;
  std::string describe_solver(double dt) final;
  void forget_cells() final { newton_.forget(); }
  void state(Archive& archive) override { newton_.state(archive); }

 protected:
  double dt() const { return equations_.dt; }  ///< of the step, s
  /// Positions at the start of the step, 4 numbers per vertex.
  const std::vector<double>& start() const { return work_.position(); }
  /// Sets the rates, x* and v* of a step of length dt; x* and v* are the current x and v before.
  virtual void set(StepEquations& equations) = 0;
  /// Solves them. Throws StepRejected where a smaller step may help, NumericalError where not.
  virtual void solve(const StepEquations& equations);
  /// What solve() does, with all errors as they come.
  virtual void find(const StepEquations& equations);

 private:
  void set_equations(double dt);

  Newton newton_;
  StepEquations equations_;
  StepWork work_;  ///< from the state at the start of the step
};

}  // namespace suture
