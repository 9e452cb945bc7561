// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bodies that are nearly incompressible: shear, bending, Cook's membrane, a block under a punch.
#include <gtest/gtest.h>

#include <cmath>

#include "kernel/mesh/box.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/reference/blocks.hpp"
#include "tests/run/equilibrium.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

enum Element { trilinear, mean_gradient };

std::map<std::string, double> neo_hooke(double young, double poisson, Element element) {
  return {{"mu", young / (2 * (1 + poisson))},
          {"lambda", young * poisson / ((1 + poisson) * (1 - 2 * poisson))},
          {"rho", 1000},
          {"element", element}};
}

// ----------------------------------------------------------------- shear of liver --

constexpr double plate = 3e-4;  // m^2

Scene shear_block(Element element) {
  const double depth = 0.01;
  Scene scene = block(host(), "tm-faure", {0.03, 0.01, depth}, {30, 10, 10},
                      {{"E", 1000}, {"nu", 0.499}, {"rho", 1000}, {"element", element}});
  hold(scene, at({any, 0, any}), 7);
  hold(scene, at({any, 0.01, any}), 7, {0.01, 0, 0});  // gamma = 1 at time 1
  return scene;
}

double stress_of(Equilibrium& found) { return found.reaction(at({any, 0.01, any}))[0] / plate; }

TEST(ShearOfLiver, HasTheStressOfAnIndependentProgramOnTheSameMesh) {
  Equilibrium found(shear_block(trilinear), 0);
  for (const reference::ShearBlock& expected : reference::shear_blocks) {
    found.proceed(expected.gamma);
    EXPECT_NEAR(stress_of(found), expected.trilinear, 1e-6 * expected.trilinear) << expected.gamma;
  }
}

// The trilinear element is 7 to 17 % too stiff.
TEST(ShearOfLiver, HasTheConvergedStressWithElementsThatDoNotLock) {
  Equilibrium found(shear_block(mean_gradient), 0);
  for (const reference::ShearBlock& expected : reference::shear_blocks) {
    found.proceed(expected.gamma);
    EXPECT_NEAR(stress_of(found), expected.converged, 0.01 * expected.converged) << expected.gamma;
  }
}

// --------------------------------------------------------------------- bending --

double beam_tip_of(double poisson, double gravity, Index n) {
  Equilibrium found(
      beam(host(), "tm-faure", 4 * n, n, gravity, {{"nu", poisson}, {"element", mean_gradient}}));
  return found.displacement(beam_tip(n))[1];
}

TEST(NearlyIncompressibleBeam, BendsWithinThreePercent) {
  const double small = reference::nearly_incompressible_tip_uy,
               less = reference::less_incompressible_tip_uy,
               full = reference::nearly_incompressible_full_load_tip_uy;
  EXPECT_NEAR(beam_tip_of(0.49, 9.8e-3, 5) / less, 1, 0.030);
  EXPECT_NEAR(beam_tip_of(0.499, 9.8e-3, 5) / small, 1, 0.032);
  EXPECT_NEAR(beam_tip_of(0.499, 9.8, 5) / full, 1, 0.033);
}

// -------------------------------------------------------------- Cook's membrane --

// Simo, Armero: Geometrically non-linear enhanced strain mixed methods, IJNME 33 (1992) 1413: a
// plate with corners (0, 0), (48, 44), (48, 60), (0, 44) in plane strain, held at the left, a shear
// load of 100 on the right edge; E = 240.565, nu = 0.499 (N, mm), neo-Hookean. n elements along
// each side; uy of the upper right corner.
double cooks_tip(Index n, Element element) {
  Mesh mesh = make_box({{0, 0, 0}, {1, 1, 1}, {n, n, 1}, {1, 1, 1}});
  for (Vec3& p : mesh.points) {
    const double low = 44 * p[0], high = 44 + 16 * p[0];
    p = {48 * p[0], low + (high - low) * p[1], p[2]};
  }
  const TemporaryFolder folder;
  Diagnostics ignored;
  write_mesh(folder / "membrane.vtu", mesh, ignored);
  Scene scene =
      block(host(), "neo-hooke", {1, 1, 1}, {1, 1, 1}, neo_hooke(240.565, 0.499, element));
  scene.mesh.box.reset();
  scene.mesh.file = folder / "membrane.vtu";
  hold(scene, at({any, any, any}), 4);
  hold(scene, at({0, any, any}), 7);
  load(scene, at({48, any, any}), {0, 100.0 / 16, 0});
  return Equilibrium(scene).displacement(at({48, 60, any}))[1];
}

TEST(CooksMembrane, DoesNotLock) {
  EXPECT_NEAR(cooks_tip(16, mean_gradient), 6.8, 0.05);  // fine meshes: 6.9
  EXPECT_LT(cooks_tip(8, trilinear), 3) << "and the trilinear element does";
}

// ------------------------------------------------------------------ block punch --

// Reese, Wriggers, Reddy: A new locking-free brick element technique for large deformation problems
// in elasticity, Computers and Structures 75 (2000) 291: a quarter of a block, pressed by a dead
// load p = 4 mu on a quarter of its top, which cannot move sideways. The drop of the middle over
// the height.
double punch(Index n, Element element) {
  const double young = 240.565, poisson = 0.499, mu = young / (2 * (1 + poisson));
  Scene scene =
      block(host(), "neo-hooke", {1, 1, 1}, {n, n, n}, neo_hooke(young, poisson, element));
  hold(scene, at({0, any, any}), 1);
  hold(scene, at({any, 0, any}), 2);
  hold(scene, at({any, any, 0}), 4);
  hold(scene, at({any, 1, any}), 5);
  load(scene, within({0, 1, 0}, {0.5, 1, 0.5}), {0, -4 * mu, 0});
  return -Equilibrium(scene).displacement(at({0, 1, 0}))[1];
}

TEST(Punch, PressesABlockByTheRightDepth) {
  EXPECT_NEAR(punch(8, mean_gradient), 0.70, 0.03 * 0.70);
}

}  // namespace
}  // namespace suture::test
