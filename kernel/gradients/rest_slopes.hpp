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

/// d(multipliers . f)/dX of the same forces, 3 numbers per vertex, in the same way: for the
/// vertices of a group at once whose elements share none. Throws InputError, too, if forces on
/// vertices depend on more than the elements around them. On a grid, 162 times the forces of models
/// that are built again.
std::vector<double> rest_slopes(Body& body, double time, const std::vector<double>& multipliers);

/// The shortest edge of an element at rest, m. O(elements).
double shortest_edge(const Body& body);

/// By central differences: all models are built again on the cells that there are now, with rest
/// positions on both sides. Loads keep the forces that they have. `direction`: 3 numbers per
/// vertex. Throws InputError if elements are only in part material, or have rest positions of their
/// own since they were sewn. Costs as much as building the models twice.
RestSlope rest_slope(Body& body, double time, std::span<const double> direction);

}  // namespace suture
