// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/gradients/equilibrium_slopes.hpp"

namespace suture::test {

/// u_y of a vertex, m.
inline double sag_at(Attributes& attributes, Index v) {
  return attributes.position().get(v, 1) - attributes.rest().get(v, 1);
}

/// J = sum of u_y^2 over all vertices, m^2.
inline double sag_of(Attributes& attributes) {
  double sum = 0;
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    sum += sag_at(attributes, v) * sag_at(attributes, v);
  return sum;
}

/// dJ/du.
inline ObjectiveSlopes sag_slopes(Attributes& attributes) {
  ObjectiveSlopes slopes;
  slopes.displacement.assign(std::size_t{attributes.vertex_count()} * 3, 0);
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    slopes.displacement[std::size_t{v} * 3 + 1] = 2 * sag_at(attributes, v);
  return slopes;
}

}  // namespace suture::test
