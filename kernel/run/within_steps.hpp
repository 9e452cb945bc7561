// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "kernel/implicit/newton.hpp"
#include "kernel/run/run_report.hpp"
#include "kernel/steps/step_control.hpp"

namespace suture {

/// For its lifetime, an observer learns what happens within steps, and is asked whether it gives a
/// step up.
class WithinSteps {
 public:
  /// `on_iteration`: also called after each iteration on the body itself.
  WithinSteps(StepControl& control, Dynamics& dynamics, Observer& observer,
              std::function<void(const Newton::Iteration&)> on_iteration = {});
  ~WithinSteps();
  WithinSteps(const WithinSteps&) = delete;
  WithinSteps& operator=(const WithinSteps&) = delete;

 private:
  StepControl& control_;
  Newton* newton_;  ///< none for explicit steps
};

}  // namespace suture
