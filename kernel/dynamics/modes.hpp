// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernel/dynamics/body.hpp"

namespace suture {

/// The lowest mode of a body about its present state.
struct LowestMode {
  double eigenvalue = 0;    ///< of M^-1 K on the free components, 1/s^2; an upper bound
  double error = 0;         ///< norm of the residual; an eigenvalue lies within this distance
  double noise = 0;         ///< the effect of rounding on 0: negative means below -noise
  std::vector<Vec3> shape;  ///< displacement of each vertex; the longest has length 1
  unsigned products = 0;    ///< with the tangent; each costs three evaluations of the forces
  bool negative() const { return eigenvalue < -noise; }
};

/// Finds the lowest eigenvalue of M^-1/2 K M^-1/2, where K = -df/dx is the symmetric part of
/// the tangent of all terms. Matrix-free.
///
/// Rayleigh-Ritz on the motions of a coarse space (coarse_space.hpp), then locally optimal
/// descent of a block of three (LOBPCG; Knyazev, SIAM J. Sci. Comput. 23 (2001) 517) from
/// the best of these, the last motion and a random vector (fixed seed). The residuals are
/// preconditioned in two levels, additively: with the eigenvalues t and vectors q of the
/// coarse space
///   T r = sum q (q.r) / max(|t|, floor) + r / lambda_max
/// so that the smooth part of a mode, which Lanczos finds last, is available at once and the rest
/// is local.
///
/// Every value found is a Rayleigh quotient: a negative one proves that the state is unstable. Only
/// a factorisation could prove that none is negative; the descent ends when the residual is below a
/// fifth of the value, or after the allowed number of products.
///
/// For the effect of rounding, see ScaledTangent::noise().
///
/// Cost: at most `products`, about half of them for the coarse space. Memory: 18 vectors of
/// 24 B per vertex. Needs body.models().has_tangent().
LowestMode find_lowest_mode(Body& body, double time, unsigned products,
                            std::span<const double> last_motion = {});

}  // namespace suture
