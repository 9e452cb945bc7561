// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace suture {

/// The largest stable step of symplectic Euler and of velocity Verlet (with viscous forces at the
/// velocity half a step earlier) for stiffness over mass k (1/s^2) and damping over mass c (1/s),
/// in s. With omega^2 = k and 2 zeta omega = c, it is
///   omega dt < 2 (sqrt(zeta^2 + 1) - zeta)  <=>  dt < 2 / (sqrt(k + c^2/4) + c/2)
/// and for systems  M - (dt/2) C - (dt^2/4) K  positive definite, which
/// block-diagonal bounds of K and C decide vertex by vertex.
/// Mass-proportional damping is integrated exactly and does not enter: with it
/// the limit is omega^2 dt^2 < 2 a coth(a/2) >= 4, a = alpha dt.
inline double stable_step(double k, double c) {
  const double rate = std::sqrt(std::max(k, 0.0) + c * c / 4) + c / 2;
  return rate > 0 ? 2 / rate : std::numeric_limits<double>::infinity();
}

}  // namespace suture
