// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/build/built_scene.hpp"

namespace suture {

/// One line about the body at rest, which shows parameters in wrong units: its size, mass and
/// density, the speed of waves in it, and the strain under its weight; then the figures that are
/// unusual for a solid. The speed is sqrt(M / rho) for the modulus M that resists a stretch along x
/// without contraction, and the strain rho g L / M for the length L of the body along gravity;
/// models without a tangent have neither. Costs one product with the tangent.
std::string describe_plausibility(BuiltScene& built);

}  // namespace suture
