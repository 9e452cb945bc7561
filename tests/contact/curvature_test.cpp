// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/curvature.hpp"

#include <gtest/gtest.h>

#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

/// Against differences of the normal of nearest().
TEST(Curvature, IsHowTheNormalTurns) {
  const double h = 1e-6;
  const Shape shapes[] = {Sphere{{0, 0, 0}, 1}, Capsule{{0, 0, -3}, {0, 0, 3}, 1},
                          Cylinder{{0, 0, -3}, {0, 0, 3}, 1}, HalfSpace{{0, 0, 0}, {1, 0, 0}}};
  for (const Shape& shape : shapes) {
    const Vec3 place{1.2, 0.3, 0.4};
    const Curvature bend = curvature(shape, place);
    const Vec3 n = nearest(shape, place).normal;
    for (Vec3 d : {Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{-0.3, 0.5, 2}}) {
      d = minus(d, scaled(dot(d, n), n));
      const Vec3 turned = minus(nearest(shape, plus(place, scaled(h, d))).normal, n);
      const Vec3 expected =
          scaled(h * bend.per_metre, minus(d, scaled(dot(bend.straight, d), bend.straight)));
      EXPECT_LT(norm(minus(turned, expected)), 1e-5 * h * norm(d) + 1e-11) << shape.index();
    }
  }
}

}  // namespace
}  // namespace suture
