// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "kernel/dynamics/dynamics.hpp"
#include "kernel/implicit/newton.hpp"

namespace suture {

/// "Newton iteration 3: residual 1e-5 of the forces, ...".
std::string note_on(const Newton::Iteration& iteration, const Newton& newton);

/// A warning of implicit steps that rounding kept above `tolerance`; "" if all reached it.
std::string rounding_warning(Dynamics& dynamics, double tolerance);

/// How far the steps of a run are from the equations of motion, where that depends on the step.
std::vector<std::string> notes_on_steps(Dynamics& dynamics);

}  // namespace suture
