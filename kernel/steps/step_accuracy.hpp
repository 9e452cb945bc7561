// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>

#include "kernel/base/archive.hpp"
#include "kernel/dynamics/local_error.hpp"

namespace suture {

/// Chooses the lengths of steps such that the error of each is at most a tolerance times the
/// largest displacement so far. The error grows with the third power of the step:
///   h' = h (0.7 tolerance / error)^(1/3)
/// A step is only changed if that pays: one that stays the same keeps the energy better, and costs
/// an explicit scheme less.
class StepAccuracy {
 public:
  /// `size`: of the body, m. Displacements below a ten-thousandth of it count as that much, so
  /// that a run may begin at rest.
  StepAccuracy(double tolerance, double size) : tolerance_(tolerance), largest_(size * nothing) {}

  /// The error that is tolerated now, m.
  double tolerated() const { return tolerance_ * largest_; }
  /// `dt`: of the first step.
  void start(double dt) { wanted_ = dt; }
  /// Judges a step of length dt: false if it must be repeated with wanted().
  bool accepts(const StepError& step, double dt);
  /// The step of length dt could not be made: it is repeated with `factor` times dt.
  void shorten(double dt, double factor);

  double wanted() const { return wanted_; }  ///< the length of the next step, s
  /// The error of the last step that was judged, in multiples of the tolerance.
  double error() const { return error_; }
  /// True if steps that start at `time` have become too short to be made.
  bool is_stuck(double time) const;
  unsigned rejections() const { return rejections_; }  ///< in succession
  std::uint64_t rejected_steps() const { return rejected_; }
  double shortest() const { return shortest_; }  ///< accepted step, s
  double longest() const { return longest_; }
  void state(Archive& archive);

 private:
  /// What moves by less than this part of the size of a body has not moved.
  static constexpr double nothing = 1e-4;

  void follow(double dt);

  double tolerance_;
  double largest_;  ///< displacement so far, m
  double wanted_ = std::numeric_limits<double>::infinity(), error_ = 0;
  unsigned rejections_ = 0;
  unsigned held_ = 0;  ///< steps that must not become longer
  std::uint64_t rejected_ = 0;
  double shortest_ = std::numeric_limits<double>::infinity(), longest_ = 0;
};

}  // namespace suture
