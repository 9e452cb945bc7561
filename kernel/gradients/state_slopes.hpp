// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/dynamics/body.hpp"
#include "kernel/gradients/model_states.hpp"
#include "kernel/gradients/parameter_slopes.hpp"

// Models with a memory
// ====================
//
// A step leads from states z to z' = e(x, z), and the forces f(x, z) are those with z'. Both are
// functions of an element, or of a point in it, which the models evaluate together. Backward, with
// Z' = dJ/dz':
//
//   dJ/dz = d(l . f + Z' . e)/dz          two evaluations per component of a state
//   dJ/dx gets d(Z' . e)/dx               two per component and group of vertices: 48 on a grid
//
// Elements are independent, so that all are changed at once.

namespace suture {

/// dL/dz of L = force . f + states . z' in a step, whose accepted states and end positions are
/// those of the body; numbered as in ModelStates. By central differences. Throws InputError for
/// states that are not on elements.
std::vector<double> slopes_by_states(Body& body, const ModelStates& states, const TangentTime& at,
                                     const Multipliers& multipliers);

/// d(weights . z')/dx in the same way, 3 numbers per vertex.
std::vector<double> slopes_by_position(Body& body, const ModelStates& states, const TangentTime& at,
                                       const std::vector<double>& weights);

}  // namespace suture
