// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/rounding.hpp"

#include <cmath>
#include <limits>

#include "kernel/dynamics/moduli.hpp"

namespace suture {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
/// A law takes ten to a hundred operations.
constexpr double roundings = 100;

/// Stretches and shears along every axis.
constexpr UniformGradient every_strain{{{1, 1, 0}, {0, 1, 1}, {1, 0, 1}}};

}  // namespace

Rounding rounding_of(const Motion& motion) {
  if (motion.last_step() == 0) return {};
  Attributes& attributes = motion.body().attributes();
  const double omega = 2 / motion.last_step();
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

double rounding_of_stored_energy(const Motion& motion) {
  Body& body = motion.body();
  if (body.models().has_tangent())
    return roundings * epsilon * std::abs(sum_of_moduli(body, every_strain, motion.time()));
  return roundings * 2 / epsilon * rounding_of(motion).energy;
}

}  // namespace suture
