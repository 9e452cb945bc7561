// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "kernel/dynamics/dynamics.hpp"

namespace suture {

/// A warning of implicit steps that rounding kept above `tolerance`; "" if all reached it.
std::string rounding_warning(Dynamics& dynamics, double tolerance);

/// How far the steps of a run are from the equations of motion, where that depends on the step.
std::vector<std::string> notes_on_steps(Dynamics& dynamics);

}  // namespace suture
