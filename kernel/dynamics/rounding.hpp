// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/dynamics/motion.hpp"

namespace suture {

/// The effect of rounding positions: the last step moved each vertex by eps |x| against a stiffness
/// of at most m (2/dt)^2. Energies of that size, times the number of steps, are noise, as are
/// forces of the corresponding size.
struct Rounding {
  double energy = 0;         ///< J, per step
  double force_squared = 0;  ///< N^2, summed over the vertices
};
/// Zero before the first step. O(vertices).
Rounding rounding_of(const Motion& motion);

}  // namespace suture
