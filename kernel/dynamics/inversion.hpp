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

/// Inverted elements that share faces form a group. A group of at most this many elements says
/// nothing about the body: it hangs on a lip, or at a step of voxels.
constexpr Index few_inverted = 8;
/// The body has at least this many elements for each inverted one, else they are part of what it
/// shows.
constexpr Index elements_per_inverted = 100;

/// What inverted elements of instances with `forbids[instance]` mean.
struct Inversion {
  Index first = none;  ///< of them
  /// The first one that ends a run, or `none`: its group is larger than few_inverted, or all of
  /// them are more than the body has for elements_per_inverted.
  Index grave = none;
  /// Those that have turned inside out, ascending, if none is grave: at a Gauss point the Jacobian
  /// is <= 0, too. All others only have a corner that is folded, where no element evaluates its
  /// law.
  std::vector<Index> turned;
};
/// `inverted`: ascending. O(inverted elements), nothing without any.
Inversion judge_inversion(Body& body, const std::vector<Index>& inverted,
                          const std::vector<bool>& forbids);

}  // namespace suture
