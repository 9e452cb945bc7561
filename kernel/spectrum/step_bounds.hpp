// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "kernel/attributes/attributes.hpp"
#include "kernel/forces/stable_step.hpp"
#include "kernel/forces/symmetric3.hpp"

namespace suture {

/// Sums of the bounds of all terms at one vertex: XX YY ZZ XY YZ XZ of K and of C.
struct BoundSums {
  std::array<double, 6> stiffness{}, damping{};

  void add(const double* k, const double* c) {
    for (std::size_t i = 0; i < 6; ++i) {
      stiffness[i] += k[i];
      damping[i] += c[i];
    }
  }
};

/// The part of a bound that acts on free components.
inline std::array<double, 6> free_part(std::array<double, 6> a, int fixed) {
  for (int c = 0; c < 3; ++c) {
    if (!(fixed >> c & 1)) continue;
    a[static_cast<std::size_t>(c)] = 0;
    a[3 + static_cast<std::size_t>(c)] = 0;  // XY, YZ, XZ
    a[3 + (static_cast<std::size_t>(c) + 2) % 3] = 0;
  }
  return a;
}

/// Per vertex, the largest eigenvalue of the summed bounds over m: K/m (1/s^2) and C/m (1/s). Holds
/// the maxima over all free vertices, and the smallest stable step (stable_step.hpp; infinite
/// without forces) with its vertex.
struct StepBounds {
  double stiffness = 0, damping = 0;
  double dt = std::numeric_limits<double>::infinity();  ///< s
  Index vertex = none;

  /// Includes a vertex unless it is fixed or removed.
  void include(Index v, const BoundSums& sums, Attributes& attributes) {
    const double mass = attributes.mass().rows()[v];
    const int bits = static_cast<int>(attributes.fixed().rows()[v]);
    if (bits == 7 || mass == 0) return;
    const double k = largest_eigenvalue(free_part(sums.stiffness, bits)) / mass;
    const double c = largest_eigenvalue(free_part(sums.damping, bits)) / mass;
    stiffness = std::max(stiffness, k);
    damping = std::max(damping, c);
    const double step = stable_step(k, c);
    if (step < dt) {
      dt = step;
      vertex = v;
    }
  }
};

}  // namespace suture
