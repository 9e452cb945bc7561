// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/dynamics/integrator.hpp"

namespace suture {

// One function per scheme; integrators.cpp lists them.
std::unique_ptr<Integrator> make_symplectic_euler(Motion& motion);
std::unique_ptr<Integrator> make_velocity_verlet(Motion& motion);

}  // namespace suture
