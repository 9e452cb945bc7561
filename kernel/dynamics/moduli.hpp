// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "kernel/dynamics/body.hpp"

namespace suture {

/// Rows of a displacement gradient.
using UniformGradient = std::array<Vec3, 3>;

/// u'K u for the tangent K of the models and the displacements u = G x, J: the moduli that resist
/// the gradient G times the volumes, summed; where elements have been pressed or softened it may be
/// negative. Needs ForceLoop::has_tangent(); costs one product with the tangent.
double sum_of_moduli(Body& body, const UniformGradient& gradient, double time);

}  // namespace suture
