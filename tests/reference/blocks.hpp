// SPDX-License-Identifier: GPL-3.0-or-later
//
// Solutions of independent programs for shear and for bodies that are nearly incompressible, with
// their provenance; all SI, St Venant-Kirchhoff.
#pragma once

namespace suture::reference {

/// Case D: a block of 30 x 10 x 10 mm (y is its height), E = 1 kPa, nu = 0.499; y = 0 is held, the
/// plate y = 10 mm moves by gamma 10 mm along x and not otherwise; four sides are free. Stress =
/// force on the plate / 3e-4 m^2.
struct ShearBlock {
  double gamma;
  /// Pa: 30 x 10 x 10 trilinear elements, 2x2x2 points, DOLFINx 0.5.2, Newton to 1e-12.
  double trilinear;
  /// Pa: graded Taylor-Hood meshes, extrapolated (order 2.38); FreeFem++ 4.11 agrees to 1e-6 at
  /// gamma = 0.01. That of 0.2 comes from the finest mesh that has a smooth solution.
  double converged;
};

inline constexpr ShearBlock shear_blocks[] = {{0.01, 3.2640555725, 3.048694},
                                              {0.05, 16.517237803, 15.334853},
                                              {0.1, 34.276218927, 31.245067},
                                              {0.2, 78.829465352, 67.241216}};

/// Case H: the beam of beam.hpp with nu = 0.499 and g = 9.8e-3 m/s^2: uy of the tip, m.
/// Taylor-Hood, graded meshes, extrapolated; +-5e-8.
inline constexpr double nearly_incompressible_tip_uy = -5.936278505846688e-4;
/// The same with nu = 0.49: quadratic elements with reduced integration (CalculiX 2.20, C3D20R,
/// linear, 4, 6 and 8 over the height), extrapolated with the order that they show at nu = 0.3 and
/// 0.499;
/// +-2e-7.
inline constexpr double less_incompressible_tip_uy = -5.943e-4;
/// With nu = 0.499 and g = 9.8 m/s^2, of the finest Taylor-Hood mesh (8x8x32): at this load the
/// continuous problem has no solution to which meshes converge.
inline constexpr double nearly_incompressible_full_load_tip_uy = -0.5013062444400;

}  // namespace suture::reference
