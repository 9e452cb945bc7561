// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/dynamics/dynamics.hpp"
#include "kernel/gradients/parameter_slopes.hpp"

// Derivatives of equilibria
// =========================
//
// An equilibrium x(p) solves f(x, p) = 0 on the free components; others are where constraints put
// them, and R = -f there. With K = -df/dx of the free components:
//
//   forward   K du/dp = df/dp                                  one solve per parameter
//   adjoint   J(u, R, W):  K^T l = dJ/du + (df_c/du)^T m       one solve for all parameters
//             dJ/dp = l . df/dp + m . df_c/dp + dJ/dW dW/dp,  with m = -dJ/dR and W the energy
//
// Where obstacles touch, gaps N^T u stay: N^T (l + m) = 0 and N^T du/dp = 0, with multipliers.
// The vector of l where a component is free, and m where it is held, is Multipliers::force.

namespace suture {

/// The partial derivatives of a function J of displacements, reactions and the stored energy.
struct ObjectiveSlopes {
  std::vector<double> displacement;  ///< dJ/du, 1/m, 3 numbers per vertex
  std::vector<double> reaction;      ///< dJ/dR, 1/N, the same; empty: 0
  double energy = 0;                 ///< dJ/dW, 1/J
};

struct Adjoint {
  /// Their forces are dJ/d(a force at each vertex), too.
  Multipliers multipliers;
  /// dJ/d(the place where each component is held), 1/m; 0 where it is free.
  std::vector<double> motion;
  unsigned iterations = 0;  ///< of the linear solves
};

/// The derivatives of an equilibrium by one parameter, 3 numbers per vertex.
struct Sensitivity {
  std::vector<double> displacement;
  std::vector<double> reaction;  ///< 0 where components are free
};

/// The derivatives of the current static equilibrium of a body. Valid until it moves or changes.
class EquilibriumSlopes {
 public:
  /// Throws InputError with the reason where there are none or where they would be wrong: no static
  /// equilibrium, a residual above the tolerance, contact with friction or between pieces, a
  /// tangent that is not symmetric, free pieces, states of models.
  explicit EquilibriumSlopes(Dynamics& dynamics);

  /// One linear solve to this relative residual, and where obstacles touch, some more. Throws
  /// InputError if the tangent is indefinite: the equilibrium is unstable.
  Adjoint adjoint(const ObjectiveSlopes& objective, double tolerance) const;
  /// The derivative of the same objective along a direction of rest positions, 3 numbers per
  /// vertex, by rest_slope(), whose errors it throws; held vertices move along. Throws InputError
  /// if constraints turn what they hold, or hold it where it was grasped.
  double along_rest(const ObjectiveSlopes& objective, const Adjoint& adjoint,
                    std::span<const double> direction) const;
  /// The same by each rest position, 3 numbers per vertex: rest_slopes(), whose cost and errors it
  /// has. Throws InputError if the objective depends on the energy.
  std::vector<double> by_rest(const ObjectiveSlopes& objective, const Adjoint& adjoint) const;
  /// From df/dp, in the same way as adjoint().
  Sensitivity sensitivity(const std::vector<double>& forces, double tolerance) const;

 private:
  /// Solves K x + N y = right and N^T (x + fixed) = 0, where obstacles hold gaps N^T x.
  struct Solution {
    std::vector<double> x, held;  ///< held: N y
    unsigned iterations = 0;
  };
  Solution solve(const std::vector<double>& right, const std::vector<double>& fixed,
                 double tolerance) const;
  unsigned add_solution(const std::vector<double>& right, double tolerance,
                        std::vector<double>& x) const;
  void require_rest() const;
  template <class Visit>
  void for_each_held(Visit visit) const;

  Dynamics& dynamics_;
  Body& body_;
  double time_;
};

}  // namespace suture
