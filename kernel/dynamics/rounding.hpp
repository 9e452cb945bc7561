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

/// The energy that rounding may add to or remove from one evaluation of the stored energy, J: the
/// terms of an energy density are as large as its moduli, also where they cancel, as
/// mu/2 (tr C - 3) - mu ln J does at rest. The work of the tangent on displacements whose gradient
/// is about one everywhere sums moduli times volumes; of that, 100 eps may be rounding. Models
/// without a tangent: from the last step and positions as in rounding_of(), which is never less.
/// Costs one product with the tangent.
double rounding_of_stored_energy(const Motion& motion);

}  // namespace suture
