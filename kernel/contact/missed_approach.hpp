// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>

#include "kernel/base/types.hpp"

namespace suture {

/// Places that may have met and passed through each other.
struct MissedApproach {
  double distance;  ///< that they had from each other, at most, m
  double way;       ///< of one relative to the other, m
  double allowed;   ///< m
};

/// Whether, on the way between two sets of positions (rows of 4), `places` that were farther apart
/// than some distance d may have approached each other by more than d + `depth`, which is found at
/// the end: for all distances up to `edge`, up to 4 edges and so on, by boxes around the ways in
/// cubes of that size. Cost: O(vertices log vertices) for each size; O(vertices) in all if
/// everything moves by the same way.
std::optional<MissedApproach> find_missed_approach(std::span<const Index> places,
                                                   const double* from, const double* to,
                                                   double edge, double depth);

}  // namespace suture
