// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "kernel/dynamics/newton.hpp"

namespace suture {

/// Finds the equilibrium at the end of a static step: at once if Newton's method converges, and
/// otherwise along a path of equilibria from the state at the start of the step. On this path, for
/// s from 0 to 1,
///  - the time of ramps and prescribed motions goes from the start to the end of the step;
///  - in the first step of a run, gravity and loads have the factor s and their values at the end;
///  - forces that are not in balance at the start, as after a cut, are held back by the part 1 - s.
/// So the state at the start is in equilibrium at s = 0. The step of s is halved where Newton's
/// method fails and doubled where it converges quickly twice in a row.
class LoadSteps {
 public:
  /// `forbids_inversion`: by instance of the body, whether an equilibrium in which one of its
  /// elements has become inverted is no solution.
  LoadSteps(Motion& motion, Newton& newton, std::vector<bool> forbids_inversion)
      : motion_(motion), newton_(newton), forbids_inversion_(std::move(forbids_inversion)) {}

  /// Moves the vertices to the equilibrium. Throws NumericalError with the part of the step up to
  /// which equilibria were found, the state there, and the element where Newton's method failed;
  /// positions are those of the last equilibrium then. Passes on StepRejected.
  void solve(const StepEquations& equations);

  static constexpr double least_step = 1.0 / 1024;

 private:
  struct Failure {
    std::string reason;
    std::uint64_t element;
  };
  bool try_equations(const StepEquations& equations);
  void refuse_inversion() const;
  void hold_back();
  StepEquations equations_at(double part) const;
  void walk();
  void report(double part, double found, double step) const;
  [[noreturn]] void refuse(double found);

  Motion& motion_;
  Newton& newton_;
  std::vector<bool> forbids_inversion_;
  StepEquations end_;               ///< of the step: s = 1
  std::vector<double> unbalanced_;  ///< at s = 0, 3 numbers per vertex, N
  std::vector<double> position_;    ///< of the last equilibrium
  std::vector<Index> inverted_;     ///< elements, at the start
  Failure failure_;                 ///< the last one
};

}  // namespace suture
