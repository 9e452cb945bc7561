// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "kernel/dynamics/dynamics.hpp"
#include "kernel/gradients/equilibrium_slopes.hpp"
#include "kernel/gradients/model_states.hpp"
#include "kernel/implicit/step_equations.hpp"
#include "kernel/implicit/step_solver.hpp"

// Derivatives of a step
// =====================
//
// A step leads from (x, v, a, z), z the states of models, to (x', v', a', z'). An implicit one
// solves
//   f(x', v', z, p) + m (g - a' - alpha v') = 0,   a' = A (x' - x*),   v' = v* + r (x' - x*)
//   x* = x + h v + c a,   v* = v + d a
// where implicit Euler has A = 1/h^2, r = 1/h, c = d = 0, Newmark A = 4/h^2, r = 2/h, c = h^2/4,
// d = h/2, and equilibria A = r = 0. Let X', V', A', Z' be dJ/d(the state at its end), e(x', z, p)
// = z', B = m A + alpha m r + r C, K = -df/dx and C = -df/dv:
//
//   (B + K) l = X' + r V' + A A' + (de/dx)^T Z'
//   X* = B l - r V' - A A',   V* = V' - (alpha m + C) l
//   X = X*,   V = h X* + V*,   A = c X* + d V*,   Z = (df/dz)^T l + (de/dz)^T Z'
//   dJ/dp += l . d(f + m (g - a' - alpha v'))/dp + Z' . de/dp
//
// Where the run starts, a = f(x, v, z, p) / m + g - alpha v. An explicit step has v' = D v + G a
// with a = f(x, v, z, p) / m + g, and x' = x + h v':
//
//   W = V' + h X',   l = G W / m,   X = X' - K l + (de/dx)^T Z',   V = D W - C l,   Z as above
//
// Components that are held have no l, X*, V* and W. On them, reactions R = -f - m g of an implicit
// step make l = -dJ/dR, whose K l joins X'.

namespace suture {

/// Throws InputError: there is no derivative of this run, for this reason.
[[noreturn]] void refuse_run(const std::string& reason);

/// A copy of a vector on vertices, 4 numbers each.
std::vector<double> rows_of(const Column& column);

/// A parameter of a model.
struct ParameterDirection {
  Instance* instance = nullptr;
  std::string name{};
  std::vector<double> weights{};  ///< in this direction of its values; empty: each of them
  /// Without an instance: a number of the scene that changes loads, gravity or motions of
  /// constraints, by the bodies of two scenes, in which it is larger and smaller by `step`.
  Body *up = nullptr, *down = nullptr;
  double step = 0;
};

/// dJ/d(a state of a run).
struct StateSlope {
  std::vector<double> position, velocity;  ///< 3 numbers per vertex
  std::vector<double> states;              ///< as ModelStates numbers them
  std::vector<double> acceleration{};      ///< of Newmark's scheme, within a run
};

/// What determines a step, and where it led.
struct StepEnds {
  double start, end, dt;         ///< s
  std::vector<double> position;  ///< at its end, rows of 4
  bool is_first = false;         ///< of the run: nothing has led to its start
};

/// The derivatives of a state of a run by one parameter.
struct StateSensitivity {
  StateSlope state;              ///< dx/dp, dv/dp, dz/dp
  std::vector<double> reaction;  ///< dR/dp, 3 numbers per vertex; 0 where components are free
};

/// One step, backward or forward.
class StepSlopes {
 public:
  /// Throws InputError with the reason where there are no derivatives: contact, a tangent that is
  /// missing.
  explicit StepSlopes(Dynamics& dynamics);

  const ModelStates& states() const { return states_; }
  /// The multipliers of forces at one end of the step, at which the body is.
  using Use =
      std::function<void(bool is_end, const Moment& moment, const Multipliers& multipliers)>;
  /// From dJ/d(its end), with the slopes of J there added to it, to dJ/d(its start). The body is in
  /// the state at its start, and is changed. One linear solve to this relative residual in implicit
  /// schemes. Throws InputError where the step does not lead there, and where there is no
  /// derivative.
  void backward(const StepEnds& step, const ObjectiveSlopes& objective, double tolerance,
                StateSlope& slope, const Use& use);
  /// From the derivatives of its start by a parameter, or by a number of the scene, to those of its
  /// end, in the same way. Throws InputError for explicit schemes and for Newmark's, too.
  void forward(const StepEnds& step, const ParameterDirection& parameter, double tolerance,
               StateSensitivity& slope);
  /// dJ/d(the place of each component at the end of the last step), where it is held; else 0.
  const std::vector<double>& motion() const { return motion_; }
  unsigned iterations() const { return iterations_; }  ///< of the linear solves

 private:
  void back_implicitly(const StepEquations& equations, const StepEnds& step,
                       const ObjectiveSlopes& objective, double tolerance, StateSlope& slope,
                       const Use& use);
  std::vector<double> find_multipliers(const StepEquations& equations,
                                       const ObjectiveSlopes& objective, double tolerance,
                                       const StateSlope& slope, Multipliers& multipliers);
  Moment moment_at_end(const StepEquations& equations, const StepEnds& step) const;
  void go_to_start(const StepEquations& equations, const std::vector<double>& damped,
                   const std::vector<double>& found, StateSlope& slope) const;
  void back_through_start(const StepEquations& equations, const StepEnds& step, StateSlope& slope,
                          const Use& use);
  void back_explicitly(const StepEnds& step, const ObjectiveSlopes& objective, StateSlope& slope,
                       const Use& use);
  void add_objective(const ObjectiveSlopes& objective, double time, StateSlope& slope);
  void add_states(const TangentTime& at, const Multipliers& multipliers,
                  std::vector<double>& states) const;
  std::vector<double> solve(const StepEquations& equations, const std::vector<double>& right,
                            double tolerance, bool is_transposed);
  /// What a number of a scene changes at fixed positions of free components.
  struct External {
    std::vector<double> forces, motion;  ///< N and m over its unit, 3 numbers per vertex
  };
  External external(const ParameterDirection& parameter, const StepEnds& step) const;
  using ValuesAt = std::function<std::vector<double>(double part)>;
  std::vector<double> slope_of(const ParameterDirection& parameter, const Moment& moment,
                               const ValuesAt& values_at);
  void finish(const ParameterDirection& parameter, const Moment& moment,
              const std::vector<double>& states, StateSensitivity& slope);
  void move_states(const std::vector<double>& states, const std::vector<double>& way,
                   double part) const;
  void require_solved(const StepEquations& equations);
  void require_transpose(const TangentTime& at);
  void require_reached(const StepEnds& step, const ExplicitStep& made,
                       const std::vector<double>& acceleration);

  Dynamics& dynamics_;
  Body& body_;
  ModelStates states_;
  StepSolver solver_;                  ///< not that of the run, which keeps its state
  std::vector<double> mass_;           ///< of each component, 3 numbers per vertex
  std::vector<std::uint8_t> is_free_;  ///< the same
  bool is_checked_ = false;
  std::vector<double> motion_;
  unsigned iterations_ = 0;
};

}  // namespace suture
