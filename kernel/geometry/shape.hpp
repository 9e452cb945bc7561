// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "kernel/base/box.hpp"
#include "kernel/base/types.hpp"

namespace suture {

class SolidSurface;

// Solids, in m.

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

/// What a closed surface of triangles encloses.
struct Triangulated {
  std::shared_ptr<const SolidSurface> surface;
  Vec3 middle{};  ///< where the origin of `surface` lies
};

using Shape = std::variant<HalfSpace, Sphere, Capsule, Box, Cylinder, Triangulated>;

/// The point of a surface that is nearest to some place.
struct Nearest {
  double distance;  ///< negative inside
  Vec3 normal;      ///< out of the solid, of length 1
};

Nearest nearest(const Shape& shape, const Vec3& place);
/// False only if the distance of the place is larger. Cheap where nearest() is not.
bool may_be_within(const Shape& shape, const Vec3& place, double distance);

/// A ball that contains the shape; infinite for a half-space.
struct Ball {
  Vec3 centre{};
  double radius = 0;
};
Ball ball_around(const Shape& shape);
/// The distance of the nearest two sides of the shape that face away from each other; infinite for
/// a half-space, at least a third of it for a plate of triangles. m
double thickness(const Shape& shape);
/// The second largest of its three extents, of a rod its diameter; infinite for a half-space. m
double width(const Shape& shape);
/// Points in the interior of the shape, which show whether it lies within another solid; none of a
/// half-space.
std::vector<Vec3> points_inside(const Shape& shape);
/// Its key in a scene: "half_space", "sphere", ...
const char* name_of(const Shape& shape);
void translate(Shape& shape, const Vec3& by);

}  // namespace suture
