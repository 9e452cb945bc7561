// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/moduli.hpp"

#include <numeric>
#include <vector>

#include "kernel/base/vec3.hpp"

namespace suture {

double sum_of_moduli(Body& body, const UniformGradient& gradient, double time) {
  const Column& position = body.attributes().position();
  std::vector<double> u, image(3 * std::size_t{position.size()});
  u.reserve(image.size());
  for (Index v = 0; v < position.size(); ++v)
    for (const Vec3& row : gradient)
      u.push_back(dot(row, Vec3{position.get(v, 0), position.get(v, 1), position.get(v, 2)}));
  body.models().add_tangent(u.data(), -1, 0, time, image.data());
  return std::inner_product(u.begin(), u.end(), image.begin(), 0.0);
}

}  // namespace suture
