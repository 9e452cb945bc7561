// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace suture {

/// What a step of implicit Euler may cost (Newton::take_step); one of them is given.
struct StepBudget {
  unsigned iterations = 0;  ///< of the linear solver; 0: any number
  double seconds = 0;       ///< of the wall clock, for the whole step; 0: any time
};

}  // namespace suture
