// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/dynamics/body.hpp"

namespace suture {

/// What changes with the rest positions X of a body along a direction D, at fixed positions.
struct RestSlope {
  std::vector<double> forces;  ///< df/dX . D of models and gravity, 3 numbers per vertex
  double energy = 0;           ///< dW/dX . D of the stored energy
};

/// By central differences: all models are built again on the cells that there are now, with rest
/// positions on both sides. Loads keep the forces that they have. `direction`: 3 numbers per
/// vertex. Throws InputError if elements are only in part material, or have rest positions of their
/// own since they were sewn. Costs as much as building the models twice.
RestSlope rest_slope(Body& body, double time, std::span<const double> direction);

}  // namespace suture
