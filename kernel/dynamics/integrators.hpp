// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/dynamics/integrator.hpp"

namespace suture {

// A function for each file with a scheme; listed in integrators.cpp.
std::unique_ptr<Integrator> make_symplectic_euler(Motion& motion);
std::unique_ptr<Integrator> make_velocity_verlet(Motion& motion);

}  // namespace suture
