// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/steps/step_accuracy.hpp"

#include <algorithm>
#include <cmath>

namespace suture {
namespace {

/// The part of the tolerance at which a new step aims, and up to which it stays as it is: the rest
/// is left for the error to grow in the next step.
constexpr double aim = 0.7, margin = 0.9;
constexpr double max_growth = 3, min_shrinkage = 0.1, max_shrinkage = 0.9;
/// A step that grows by less is not worth the change.
constexpr double min_growth = 1.2;
/// After a step that could not be made, steps keep their length for so many.
constexpr unsigned held_steps = 4;
/// By then a step is at least a millionth of the first one.
constexpr unsigned max_rejections = 20;

}  // namespace

bool StepAccuracy::accepts(const StepError& step, double dt) {
  const double largest = std::max(largest_, step.displacement);
  error_ = step.error / (tolerance_ * largest);
  if (!(error_ <= 1)) {
    // A jump of the forces makes an error of second order, which the second attempt reveals.
    const double order = rejections_ == 0 ? 3 : 2;
    const double factor = std::pow(aim / error_, 1 / order);
    shorten(dt, std::isfinite(factor) ? factor : min_shrinkage);
    held_ = 1;
    return false;
  }
  largest_ = largest;
  rejections_ = 0;
  shortest_ = std::min(shortest_, dt);
  longest_ = std::max(longest_, dt);
  follow(dt);
  return true;
}

/// The step after one that was accepted. A stop may have made this one shorter than wanted.
void StepAccuracy::follow(double dt) {
  const double accurate = dt * std::cbrt(aim / error_);
  if (held_ > 0) {
    --held_;
    wanted_ = std::min(wanted_, accurate);
    return;
  }
  const double next = std::min(accurate, std::max(max_growth * dt, wanted_));
  if (next > min_growth * wanted_ || next < std::cbrt(aim / margin) * wanted_) wanted_ = next;
}

void StepAccuracy::shorten(double dt, double factor) {
  wanted_ = dt * std::clamp(factor, min_shrinkage, max_shrinkage);
  held_ = held_steps;
  ++rejections_;
  ++rejected_;
}

bool StepAccuracy::is_stuck(double time) const {
  return rejections_ >= max_rejections || !(time + wanted_ > time);
}

void StepAccuracy::state(Archive& archive) {
  archive("largest", largest_);
  archive("wanted", wanted_);
  archive("error", error_);
  archive("rejections", rejections_);
  archive("held", held_);
  archive("rejected", rejected_);
  archive("shortest", shortest_);
  archive("longest", longest_);
}

}  // namespace suture
