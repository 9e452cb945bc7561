// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/rounding.hpp"

#include <limits>

namespace suture {

Rounding rounding_of(const Motion& motion) {
  if (motion.last_step() == 0) return {};
  Attributes& attributes = motion.body().attributes();
  const double omega = 2 / motion.last_step(), epsilon = std::numeric_limits<double>::epsilon();
  const double *x = attributes.position().rows(), *mass = attributes.mass().rows();
  Rounding sum;
  for (Index v = 0; v < attributes.vertex_count(); ++v, x += 4) {
    const double stiffness = mass[v] * omega * omega;
    const double squared = epsilon * epsilon * (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    sum.energy += stiffness * squared / 2;
    sum.force_squared += stiffness * stiffness * squared;
  }
  return sum;
}

}  // namespace suture
