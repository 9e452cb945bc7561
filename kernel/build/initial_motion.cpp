// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/build/initial_motion.hpp"

#include "kernel/base/vec3.hpp"

namespace suture {
namespace {

Vec3 row(const Column& column, Index v) {
  return {column.get(v, 0), column.get(v, 1), column.get(v, 2)};
}

/// c = sum m X / sum m
Vec3 centre_of_mass(std::span<const Index> vertices, Attributes& attributes) {
  double mass = 0;
  Vec3 moment{};
  for (const Index v : vertices) {
    const double m = attributes.mass().get(v, 0);
    const Vec3 X = row(attributes.rest(), v);
    for (std::size_t c = 0; c < 3; ++c) moment[c] += m * X[c];
    mass += m;
  }
  for (double& component : moment) component /= mass;
  return moment;
}

}  // namespace

void add_initial_motion(const InitialMotion& motion, std::span<const Index> vertices,
                        Attributes& attributes) {
  const Vec3 centre = motion.centre ? *motion.centre : centre_of_mass(vertices, attributes);
  for (const Index v : vertices) {
    const Vec3 turned = cross(motion.spin, minus(row(attributes.rest(), v), centre));
    for (int c = 0; c < 3; ++c) {
      const auto i = static_cast<std::size_t>(c);
      attributes.velocity().set(v, c,
                                attributes.velocity().get(v, c) + motion.velocity[i] + turned[i]);
    }
  }
}

}  // namespace suture
