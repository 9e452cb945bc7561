// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kernel/dynamics/constraints.hpp"

namespace suture {

/// A constraint of a scene with the vertices that it selects.
struct PlacedConstraint {
  std::string path;  ///< "/constraints/0"
  std::uint8_t components;
  PrescribedMotion motion;
  std::vector<Index> vertices;
};

/// Refuses constraints that give a component of a vertex different motions: throws one InputError
/// with a line for each pair of them, with the number of such vertices and the first, which `name`
/// describes. Constraints that agree there to 1e-12 may overlap. O(vertices + constrained ones).
void check_constraints(const std::vector<PlacedConstraint>& constraints, const Column& rest,
                       const std::function<std::string(Index)>& name);

}  // namespace suture
