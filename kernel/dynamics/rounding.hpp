// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/dynamics/motion.hpp"

namespace suture {

/// What the rounding of positions amounts to: the last step moved each vertex by
/// eps |x|, against a stiffness of at most m (2/dt)^2. Energies of that size, times
/// the steps made, are noise, and so are forces.
struct Rounding {
  double energy = 0;         ///< J, of a step
  double force_squared = 0;  ///< N^2, summed over the vertices
};
/// Zero before the first step. O(vertices).
Rounding rounding_of(const Motion& motion);

}  // namespace suture
