// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/dynamics/integrator.hpp"

namespace suture {

// One function per scheme; integrators.cpp lists them.
using MakeIntegrator = std::unique_ptr<Integrator>(Motion& motion,
                                                   const IntegratorOptions& options);
MakeIntegrator make_symplectic_euler, make_velocity_verlet, make_implicit_euler, make_newmark,
    make_xpbd, make_static_equilibrium;

}  // namespace suture
