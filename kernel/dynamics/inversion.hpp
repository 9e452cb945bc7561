// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/dynamics/body.hpp"

namespace suture {

/// Elements with a corner Jacobian <= 0 at the current positions, ascending. O(elements), much
/// cheaper than an evaluation of forces.
std::vector<Index> find_inverted(const CellComplex& complex, Attributes& attributes);

/// The inverted elements except for those in `allowed` (ascending).
std::vector<Index> find_inverted(Body& body, const std::vector<Index>& allowed);

/// The first of these elements that belongs to an instance with `forbids[instance]`, or `none`.
Index first_forbidden(const Body& body, const std::vector<Index>& inverted,
                      const std::vector<bool>& forbids);

}  // namespace suture
