// SPDX-License-Identifier: GPL-3.0-or-later
//
// Two of the cases of `./dev bench work-precision`, extrapolated from two small meshes with the
// order that theory gives, beside values of other programs.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "kernel/mesh/box.hpp"
#include "tests/run/equilibrium.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

/// The limit of values whose error falls with h^order, from those with h and h/2.
double limit_of(double coarse, double fine, double order) {
  return fine + (fine - coarse) / (std::pow(2, order) - 1);
}

constexpr double second_element = 1;  // mean-gradient

// Cook's membrane in plane strain: corners (0, 0), (48, 44), (48, 60), (0, 44) mm, E = 70 MPa,
// nu = 1/3, a shear traction of 6.25 MPa; here a hundred-thousandth of it, which is linear. uy of
// the upper right corner, mm at the full traction.
double membrane_tip(Index n) {
  constexpr double part = 1e-5;
  Mesh mesh = make_box({{0, 0, 0}, {1, 1, 1}, {n, n, 1}, {1, 1, 1}});
  for (Vec3& p : mesh.points) {
    const double low = 44 * p[0], high = 44 + 16 * p[0];
    p = {48 * p[0], low + (high - low) * p[1], p[2]};
  }
  Scene scene = block(host(), "tm-faure", {1, 1, 1}, {1, 1, 1},
                      {{"E", 70e6}, {"nu", 1.0 / 3}, {"rho", 1000}, {"element", second_element}});
  scene.mesh.box.reset();
  scene.mesh.given = std::make_shared<Mesh>(std::move(mesh));
  hold(scene, at({any, any, any}), 4);
  hold(scene, at({0, any, any}), 7);
  load(scene, at({48, any, any}), {0, 6.25e6 * part, 0});
  return Equilibrium(scene).displacement(at({48, 60, any}))[1] / part;
}

// CoFEA's benchmark of this plate (in solids4foam's tutorial cooksMembrane): 32.27 by CalculiX,
// 32.20 by Code_Aster, 32.28 by Elmer on very fine meshes, 32.30 extrapolated: the tolerance is
// what they differ by. The order is 1.1, that of the corner at the upper end of the clamp.
TEST(CooksMembrane, InPlaneStrainApproachesWhatThreeOtherProgramsFind) {
  const double coarse = membrane_tip(8), fine = membrane_tip(16);
  EXPECT_NEAR(limit_of(coarse, fine, 1.1), 32.27, 0.1);
  EXPECT_LT(coarse, fine) << "from below";
  EXPECT_LT(fine, 32.2);
}

// A bar of 1 m x (0.25 m)^2 between grips, one of which is turned by 90 degrees: the torque about
// its axis. Quadratic elements of CalculiX, extrapolated: 135.254 N m, the finest being 0.04 % off.
double twisting_torque(Index n) {
  Scene scene = block(host(), "tm-faure", {1, 0.25, 0.25}, {4 * n, n, n},
                      {{"E", 4e5}, {"nu", 0.3}, {"rho", 1000}, {"element", second_element}});
  hold(scene, at({0, any, any}), 7);
  Constraint& turned = hold(scene, at({1, any, any}), 7);
  turned.axis = {1, 0, 0};
  turned.centre = {0.5, 0.125, 0.125};
  turned.angle = std::numbers::pi / 2;
  turned.moves = true;
  Equilibrium found(scene);
  // M - p x R, for a point p of the axis
  const Eigen::Vector3d r = found.reaction(at({1, any, any}));
  return found.moment(at({1, any, any}))[0] - 0.125 * (r[2] - r[1]);
}

// The section's warping is smooth: order 2, as of Saint-Venant's torsion. The next order is 4.
TEST(Twist, By90DegreesHasTheTorqueThatAnotherProgramFinds) {
  const double coarse = twisting_torque(5), fine = twisting_torque(10), expected = 135.254;
  EXPECT_NEAR(std::log2((coarse - expected) / (fine - expected)), 2, 0.2);
  EXPECT_NEAR(limit_of(coarse, fine, 2), expected, 0.002 * expected);
}

}  // namespace
}  // namespace suture::test
