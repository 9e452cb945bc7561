// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "kernel/base/types.hpp"

namespace suture {

/// A boundary face as a bilinear surface x(r, s), r and s from 0 to 1, through its corners
/// (counterclockwise from outside). It has no fold along a diagonal, so a vertex that slides over
/// it feels no kink, and the result does not depend on which diagonal was chosen.
struct Patch {
  std::array<Vec3, 4> corners;

  /// The foot of a place on the patch, or on its rim.
  struct Foot {
    std::array<double, 4> weights;  ///< of the corners
    Vec3 normal;                    ///< of the surface there, outward, of length 1
    Vec3 offset;                    ///< from the foot to the place
  };
  Vec3 centre() const;
  /// False only if the place is farther away than `distance`.
  bool may_be_within(double distance, const Vec3& place) const;
  /// The place is farther than `distance` from all corners along the mean normal.
  bool is_in_front(const Vec3& place, const Vec3& normal, double distance) const;
  /// By Gauss-Newton steps from the middle, which are exact where the face is flat.
  Foot foot(const Vec3& place) const;
};

}  // namespace suture
