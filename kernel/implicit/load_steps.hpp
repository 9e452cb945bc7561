// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/implicit/load_path.hpp"

namespace suture {

/// Finds the equilibrium at the end of a static step: at once if Newton's method converges and
/// nothing is turned by more than 45 degrees, and otherwise along a LoadPath, with a step that is
/// halved where Newton's method fails and doubled where it converges quickly twice in a row.
class LoadSteps {
 public:
  explicit LoadSteps(LoadPath& path) : path_(path) {}

  /// Moves the vertices to the equilibrium. Throws NumericalError with the part of the step up to
  /// which equilibria were found, the state there, and the element where Newton's method failed;
  /// positions are those of the last equilibrium then. Passes on StepRejected.
  void solve(const StepEquations& equations);

  static constexpr double least_step = 1.0 / 1024;

 private:
  void walk();
  void report(double part, double found, double step) const;

  LoadPath& path_;
};

}  // namespace suture
