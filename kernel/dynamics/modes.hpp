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
  double error = 0;         ///< norm of the residual: an eigenvalue is within it
  double noise = 0;         ///< what rounding can make of 0: negative means below -noise
  std::vector<Vec3> shape;  ///< displacement of each vertex, the longest is 1
  unsigned products = 0;    ///< with the tangent, three evaluations of the forces each
  bool negative() const { return eigenvalue < -noise; }
};

/// Finds the lowest eigenvalue of M^-1/2 K M^-1/2, K = -df/dx the tangent of all terms
/// (not of pressures, whose direction follows the surface), matrix-free.
///
/// Rayleigh-Ritz on the motions of a coarse space (coarse_space.hpp), then locally optimal
/// descent of a block of three (LOBPCG; Knyazev, SIAM J. Sci. Comput. 23 (2001) 517) from
/// the best of these, the last motion and a random vector (fixed seed). The residuals are
/// preconditioned in two levels, additively: with the eigenvalues t and vectors q of the
/// coarse space
///   T r = sum q (q.r) / max(|t|, floor) + r / lambda_max
/// so that the smooth part of a mode, to which Lanczos comes last, is there at once and
/// the rest is local.
///
/// Every value found is a Rayleigh quotient: a negative one proves that the state is
/// unstable. That none is negative is proved by nothing short of a factorisation; the
/// descent ends at a residual below a fifth of the value, or with the products allowed.
///
/// Rounding: products are exact to eps lambda_max, and positions rounded by eps |x| change
/// strains by eps |x| / h; noise = lambda_max (1e-12 + 8 eps |x| / h).
///
/// Cost: at most `products`, about half of them for the coarse space. Memory: 18 vectors of
/// 24 B per vertex. Needs body.models().has_tangent().
LowestMode find_lowest_mode(Body& body, double time, unsigned products,
                            std::span<const double> last_motion = {});

}  // namespace suture
