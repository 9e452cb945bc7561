// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "kernel/base/box.hpp"
#include "kernel/base/types.hpp"

namespace suture {

// Solids in closed form, in m.

/// Everything behind a plane: its normal points out of the solid.
struct HalfSpace {
  Vec3 point{}, normal{0, 0, 1};  ///< normal of length 1
};
struct Sphere {
  Vec3 centre{};
  double radius = 0;
};
/// The points within `radius` of a segment.
struct Capsule {
  Vec3 from{}, to{};
  double radius = 0;
};
/// With flat ends.
struct Cylinder {
  Vec3 from{}, to{};
  double radius = 0;
};

using Shape = std::variant<HalfSpace, Sphere, Capsule, Box, Cylinder>;

/// The point of a surface that is nearest to some place.
struct Nearest {
  double distance;  ///< negative inside
  Vec3 normal;      ///< out of the solid, of length 1
};

Nearest nearest(const Shape& shape, const Vec3& place);

/// A ball that contains the shape; infinite for a half-space.
struct Ball {
  Vec3 centre{};
  double radius = 0;
};
Ball ball_around(const Shape& shape);
/// Points in the interior of the shape, which show whether it lies within another solid; none of a
/// half-space.
std::vector<Vec3> points_inside(const Shape& shape);
/// Its key in a scene: "half_space", "sphere", ...
const char* name_of(const Shape& shape);
void translate(Shape& shape, const Vec3& by);

}  // namespace suture
