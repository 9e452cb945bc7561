// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/rounding.hpp"

#include <cmath>
#include <limits>

#include "kernel/dynamics/moduli.hpp"
#include "kernel/forces/sum_of_blocks.hpp"

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
  const PartialRows::OwnIsEnough own(attributes.partial_rows());
  const double omega = 2 / motion.last_step();
  const double *x = attributes.position().rows(), *mass = attributes.mass().rows();
  const auto in_block = [&](Index first, Index end) {
    std::array<double, 2> sums{};
    for (Index v = first; v < end; ++v) {
      const double* const at = x + std::size_t{v} * 4;
      const double squared = at[0] * at[0] + at[1] * at[1] + at[2] * at[2];
      const double stiffness = mass[v] * omega * omega;
      sums[0] += stiffness / 2 * epsilon * epsilon * squared;
      sums[1] += stiffness * stiffness * epsilon * epsilon * squared;
    }
    return sums;
  };
  const auto [energy, force] = sums_of_blocks<2>(motion.body().share(), attributes.vertex_count(),
                                                 BodyShare::block, in_block);
  return {energy, force};
}

double rounding_of_stored_energy(const Motion& motion) {
  Body& body = motion.body();
  if (body.models().has_tangent())
    return roundings * epsilon * std::abs(sum_of_moduli(body, every_strain, motion.time()));
  return roundings * 2 / epsilon * rounding_of(motion).energy;
}

}  // namespace suture
