// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bars whose surface crosses the elements of a grid, beside closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <memory>

#include "kernel/implicit/newton.hpp"
#include "tests/parts/plane_parts.hpp"
#include "tests/run/equilibrium.hpp"

namespace parts_test {
namespace {

using namespace suture;
using test::any;
using test::at;

PluginHost& host() {
  static PluginHost plugins;
  return plugins;
}

Scene scene_of(Mesh mesh, double nu, int element) {
  Scene scene = test::block(host(), "tm-faure", {1, 1, 1}, {1, 1, 1},
                            {{"E", 1e5}, {"nu", nu}, {"rho", 1000}, {"element", element}});
  scene.mesh.box.reset();
  scene.mesh.given = std::make_shared<Mesh>(std::move(mesh));
  return scene;
}

/// A set of the mesh: selections by place see the surface, which these parts do not have.
Selection end_face(const char* name) {
  Selection selection;
  selection.what = Selection::Named{name};
  return selection;
}

/// The planes of a bar along x with a square section of this side, turned about its axis by
/// `angle`, the centre of the section being at (y, z) = (c, c).
std::vector<Level> square_bar(double side, double angle, double c) {
  std::vector<Level> planes;
  for (int i = 0; i < 4; ++i) {
    const double a = angle + i * std::acos(0.0);
    const Vec3 normal{0, std::cos(a), std::sin(a)};
    planes.push_back(half_space(normal, {0, c + side / 2 * normal[1], c + side / 2 * normal[2]}));
  }
  return planes;
}

// A constant stress is in the space of the elements, whatever part of them is material: the force
// is exact, and so is the contraction.
TEST(PartBars, StretchAsTheirSectionTells) {
  const double side = 0.1, strain = 1e-7, length = 0.3;
  for (const int element : {0, 1}) {
    const Mesh mesh =
        cut_box({.size = {length, 0.15, 0.15}, .cells = {6, 3, 3}}, square_bar(side, 0.4, 0.075));
    Scene scene = scene_of(mesh, 0.3, element);
    test::hold(scene, end_face("x0"), 1);
    test::hold(scene, at({0, 0.05, 0.05}), 7);
    test::hold(scene, at({0, 0.1, 0.05}), 4);
    test::hold(scene, end_face("x1"), 1, {strain * length, 0, 0});
    test::Equilibrium bar(scene);
    EXPECT_NEAR(bar.reaction(end_face("x1"))[0] / (1e5 * side * side * strain), 1, 1e-5);
    EXPECT_LT(bar.distance([&](const Eigen::Vector3d& X) {
      return Eigen::Vector3d(X[0] * (1 + strain), X[1] - 0.3 * strain * (X[1] - 0.05),
                             X[2] - 0.3 * strain * (X[2] - 0.05));
    }),
              1e-4 * strain * length);
  }
}

/// The energy of a bar between ends that are turned by a small angle, over E I angle^2 / 2 L. With
/// nu = 0, every section stays plane, and beam theory is exact.
double bending_energy(int cells, int element, double warp) {
  const double side = 0.1, width = 0.15, length = 0.15, angle = 1e-5;
  const auto n = static_cast<Index>(cells);
  const BoxOptions box{.size = {length, width, width}, .cells = {n, n, n}};
  const std::vector<Level> planes = square_bar(side, 0.4, width / 2);
  const Mesh mesh = warp == 0 ? cut_box(box, planes)
                              : cut_mesh(warped(make_box(box), warp * width / cells), planes);
  Scene scene = scene_of(mesh, 0, element);
  test::hold(scene, end_face("x0"), 7);
  Constraint& turned = test::hold(scene, end_face("x1"), 7, {0, angle * length / 2, 0});
  turned.axis = {0, 0, 1};
  turned.centre = {length, width / 2, width / 2};
  turned.angle = angle;
  const double inertia = side * side * side * side / 12;
  return test::Equilibrium(scene).energy() / (1e5 * inertia * angle * angle / (2 * length));
}

TEST(PartBars, BendWithOrderTwo) {
  for (const int element : {0, 1})
    for (const double warp : {0.0, 0.2}) {
      const double coarse = std::abs(bending_energy(4, element, warp) - 1),
                   fine = std::abs(bending_energy(8, element, warp) - 1);
      RecordProperty("errors_" + std::to_string(element) + (warp == 0 ? "" : "_warped"),
                     std::to_string(coarse) + " " + std::to_string(fine));
      EXPECT_GT(std::log2(coarse / fine), 1.7) << coarse << " and " << fine << ", warp " << warp;
      EXPECT_LT(fine, 0.03);
    }
}

/// Iterations of the linear solves for a bar that sags, of which a layer of elements on top has the
/// given fraction.
unsigned iterations(double fraction, double* shift = nullptr) {
  const double edge = 0.0125;
  const std::vector<Level> top{half_space({0, 0, 1}, {0, 0, edge * (7 + fraction)})};
  Scene scene = scene_of(
      cut_box({.size = {32 * edge, 8 * edge, 8 * edge}, .cells = {32, 8, 8}}, top), 0.3, 1);
  scene.gravity = {0, 0, -1e-3};
  test::hold(scene, end_face("x0"), 7);
  scene.solver.integrator = "static";
  scene.solver.threads = 1;
  Diagnostics diagnostics;
  BuiltScene built(scene, diagnostics);
  unsigned most = 0;
  built.dynamics().newton()->on_iteration = [&](const Newton::Iteration& i) {
    if (i.coarse_nodes == 0) most = std::max(most, i.linear_iterations);
  };
  built.dynamics().start();
  built.dynamics().step(1, 1);
  built.dynamics().synchronise();
  if (shift != nullptr) {
    *shift = 0;
    Attributes& all = built.body().attributes();
    for (Index v = 0; v < all.vertex_count(); ++v)
      *shift = std::min(*shift, all.position().get(v, 2) - all.rest().get(v, 2));
  }
  return most;
}

TEST(PartBars, AreSolvedInAsManyIterationsWhateverTheFraction) {
  const unsigned whole = iterations(1);
  EXPECT_GT(whole, 0u);
  for (const double fraction : {0.5, 1e-2, 1e-5, 1e-9}) {
    double shift = 0;
    const unsigned parts = iterations(fraction, &shift);
    RecordProperty("iterations_" + std::to_string(fraction), static_cast<int>(parts));
    EXPECT_LE(parts, whole + 3) << fraction;
    EXPECT_LT(shift, 0);
    EXPECT_GT(shift, -1e-3);
  }
}

}  // namespace
}  // namespace parts_test
