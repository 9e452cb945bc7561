// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/dynamics/body.hpp"

namespace suture {

/// Elements with a corner Jacobian <= 0 at the current positions, ascending. O(elements), much
/// cheaper than an evaluation of forces.
std::vector<Index> find_inverted(const CellComplex& complex, Attributes& attributes,
                                 loops::Rows elements = {0, none});

/// The inverted elements except for those in `allowed` (ascending).
std::vector<Index> find_inverted(Body& body, const std::vector<Index>& allowed);

/// A body bears so many inverted elements, in per cent. Most of them only have a corner that is
/// folded, where no element evaluates its law: cubes on the lip of a cut, or at a step of voxels.
constexpr Index percent_inverted = 3;
/// Elements that have turned inside out (the Jacobian is <= 0 at a Gauss point, too) and share
/// faces form a group. The body bears groups of at most this many.
constexpr Index few_turned = 8;

/// What inverted elements of instances with `forbids[instance]` mean.
struct Inversion {
  Index first = none;         ///< the first of them
  std::vector<Index> turned;  ///< those that have turned inside out, ascending
  /// The first one that the body does not bear, so that it ends a run, or `none`.
  Index fatal = none;
};
/// `inverted`: ascending. O(inverted elements), nothing without any.
Inversion judge_inversion(Body& body, const std::vector<Index>& inverted,
                          const std::vector<bool>& forbids);

}  // namespace suture
