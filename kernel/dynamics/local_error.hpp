// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/dynamics/motion.hpp"

namespace suture {

/// The error that one step adds to the displacements, s. Both lengths are root mean squares over
/// the free components, weighted by mass, m.
struct StepError {
  double error = 0;
  double displacement = 0;  ///< from rest, at the end of the step
  Index vertex = none;      ///< where the error is largest
};

/// Estimates the error of a step from the change of the accelerations over it: the term of third
/// order in which a scheme of second order differs from the Taylor series,
///   e = c h^2 (a' - a),   c = |1/6 - beta|
/// (Zienkiewicz and Xie, A simple error estimator and adaptive time stepping procedure for dynamic
/// analysis, Earthquake Eng. Struct. Dyn. 20 (1991) 871-887). The forces at the end of a step are
/// those with which the next one begins, so this costs one pass over the vertices.
class LocalError {
 public:
  /// `constant`: c of the scheme.
  LocalError(Motion& motion, double constant) : motion_(motion), constant_(constant) {}

  /// Call before the step.
  void begin();
  /// The error of the step of length dt that has been made since. Throws the errors of terms.
  StepError measure(double dt);
  /// The time in which the velocities and accelerations at the start move the body by `distance`
  /// (root mean square as above), s; infinite where nothing moves.
  double time_to_move(double distance);

 private:
  template <class Visit>
  void for_each_free(Visit visit) const;

  Motion& motion_;
  double constant_;
  std::vector<Vec3> start_;  ///< accelerations at the start of the step
};

}  // namespace suture
