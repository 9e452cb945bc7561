// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/base/archive.hpp"
#include "kernel/gradients/step_slopes.hpp"

namespace suture {

/// The derivatives of a run by a few parameters, step by step from its start: of everything at
/// once, for one linear solve and some eight evaluations of the forces per parameter and step.
/// Nothing of the run is kept but the last state.
class FollowedSlopes {
 public:
  /// From the current state on, which does not depend on the parameters. Throws the errors of
  /// StepSlopes.
  FollowedSlopes(Dynamics& dynamics, std::vector<ParameterDirection> parameters, double tolerance);

  /// To be called after every step. Throws the errors of StepSlopes::forward(); InputError if cells
  /// have changed or if the run went back.
  void follow();
  const StateSensitivity& of(std::size_t parameter) const { return slopes_[parameter]; }

 private:
  Dynamics& dynamics_;
  std::vector<ParameterDirection> parameters_;
  double tolerance_, time_;
  StepSlopes step_;
  StateBuffer before_;
  std::vector<StateSensitivity> slopes_;
};

}  // namespace suture
