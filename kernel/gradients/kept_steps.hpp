// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kernel/gradients/equilibrium_slopes.hpp"
#include "kernel/implicit/step_equations.hpp"

// Derivatives of runs
// ===================
//
// A step of implicit Euler leads from (x, v) to (x', v'), with v' = (x' - x) / h and
//   f(x', p) + m (g - a - alpha v') = 0,   a = (x' - x - h v) / h^2
// Let X', V' be the derivatives of J by the state at its end. With B = m / h^2 + alpha m / h and
// K = -df/dx of the free components:
//
//   (B + K) l = X' + V' / h
//   X = B l - V' / h,   V = m l / h                            at its start, for the step before
//   dJ/dp += l . d(f + m (g - a - alpha v'))/dp
//
// A J that is a sum over steps adds its slopes to X.

namespace suture {

/// The derivatives of a run by what determines it.
struct RunAdjoint {
  /// One per step: their forces are dJ/d(a force at each vertex in this step).
  std::vector<Multipliers> steps;
  std::vector<double> position, velocity;  ///< dJ/d(those at the start), 3 numbers per vertex
  unsigned iterations = 0;                 ///< of the linear solves
};

/// The steps of a run of implicit Euler, kept for derivatives: 24 B per vertex and step. A cut, or
/// whatever else changes the body between two steps, ends what has a derivative.
class KeptSteps {
 public:
  /// From the current state on, of steps of implicit Euler. Throws InputError with the reason where
  /// there are no derivatives: contact, forces that depend on velocities or on states of models.
  explicit KeptSteps(Dynamics& dynamics);

  /// To be called after every step. O(vertices).
  void keep();
  std::size_t count() const { return steps_.size(); }

  /// The slopes of J by the state after a step (1 to count()), in which the body is when it is
  /// called; an empty displacement for none. Those by reactions are not used.
  using SlopesAt = std::function<ObjectiveSlopes(std::size_t step)>;
  /// Backward over all steps, with a linear solve and an evaluation of the forces each. Throws
  /// InputError with the reason where there are no derivatives: no steps, steps that differ in
  /// length or that do not solve their equations, an indefinite or unsymmetric tangent. The body is
  /// as before when it returns, bit by bit.
  RunAdjoint adjoint(const SlopesAt& slopes_at, double tolerance);

  /// dJ/dp for each value of a parameter of a model, or in a direction: see ParameterSlopes. Two
  /// evaluations of the forces per step.
  std::vector<double> each(Instance& instance, const std::string& parameter,
                           std::span<const Multipliers> multipliers);
  double along(Instance& instance, const std::string& parameter, std::span<const double> weights,
               std::span<const Multipliers> multipliers);

 private:
  struct Step {
    double time, dt;
    std::vector<double> position;  ///< at its end, 3 numbers per vertex
  };
  class Visit;

  static constexpr double same_step = 1e-9;  ///< of the lengths of steps, relative
  const std::vector<double>& position_after(std::size_t step) const;
  double velocity_after(std::size_t step, std::size_t i) const;
  StepEquations equations(std::size_t step) const;
  std::vector<double> inertia(std::size_t step) const;
  void go_to(std::size_t step);
  void require_solved(const StepEquations& equations);
  void require_unchanged() const;
  std::vector<double> solve(const StepEquations& equations, const std::vector<double>& right,
                            double tolerance, unsigned& iterations);
  double add_slopes(const ObjectiveSlopes& slopes, double time, std::vector<double>& by_position);
  template <class Use>
  void for_each_step(Instance& instance, const std::string& parameter,
                     std::span<const Multipliers> multipliers, Use use);

  Dynamics& dynamics_;
  Body& body_;
  double start_;                             ///< s
  std::vector<double> position_, velocity_;  ///< at the start, 3 numbers per vertex
  std::vector<double> held_;                 ///< the column `fixed`
  std::vector<Step> steps_;
  std::string broken_;  ///< why there are no derivatives any more; empty: there are
};

}  // namespace suture
