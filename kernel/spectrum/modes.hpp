// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernel/dynamics/body.hpp"

// Balance is not stability
// ========================
//
//        |  load             A column at ten times its Euler load stays straight in a search for
//        v                   rest: its mesh, its load and its rounding are symmetric. The lowest
//       | |        ( (       eigenvalue of M^-1/2 K M^-1/2 reveals that the smallest disturbance
//       | |   ->    ) )      would grow.
//       |_|        (_(
//
// The spectrum spans 10^6 to 10^8. Lanczos from a random vector needs about 5 / sqrt(relative gap)
// products to resolve the low end. That is 7,000 for a column of 20x4x4 at 1.5 times its load,
// where the search for rest takes 2,430 steps, the cost of 480 products. Low modes are smooth or,
// with springs, checkerboards. A Galerkin projection on the trilinear functions of 30 to 100 nodes
// of a background grid holds the smooth ones, with a separate grid for each island. The same
// functions times the checkerboards hold the others, where the model does not resist them. The
// search then takes 80 to 350 products, 116 on the paper's beam.
//
// Lowest eigenvalue in 1/s^2, cantilever columns of 1 x 0.1 x 0.1 m (a slender beam: 10.3 (1 -
// p)):
//
//   load over Euler's, p                              0.5    0.9    1.5     3      10
//   10x2x2 (shear locking: 1.5 times too stiff)       10.9   6.9    -0.74   -17.9  -269
//   20x4x4                                            6.9    2.4    -4.1    -26.0  -446
//   40x4x4                                            5.9    1.5    -5.3    -28.3  -498

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
