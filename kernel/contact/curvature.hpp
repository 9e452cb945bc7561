// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/geometry/shape.hpp"

namespace suture {

/// How the normal of nearest() turns with the place: along d, at right angles to the normal n,
///   dn = per_metre (d - (straight . d) straight)
struct Curvature {
  double per_metre = 0;  ///< 1 / distance from the centre or the axis
  Vec3 straight{};       ///< direction in which the surface does not bend; 0 on a sphere
};

/// Returns the curvature of a round surface at the point nearest to `place`; 0 on flat surfaces,
/// and at edges, where normals jump.
Curvature curvature(const Shape& shape, const Vec3& place);

}  // namespace suture
