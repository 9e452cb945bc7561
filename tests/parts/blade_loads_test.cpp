// SPDX-License-Identifier: GPL-3.0-or-later
//
// Loads on bodies that are cut along blades: they stay on the surface of the body.
#include <gtest/gtest.h>

#include <cmath>

#include "kernel/base/rows.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/run/simulation.hpp"
#include "tests/forces/load_sums.hpp"
#include "tests/parts/blade_event.hpp"
#include "tests/run/equilibrium.hpp"
#include "tests/run/open_scene.hpp"

namespace suture::test::blade_loads_test {
namespace {

using spring_model::forces_of_term;

const Vec3 normal = scaled(1 / norm({1, 0.3, 0.6}), {1, 0.3, 0.6});

/// A bar of 8 x 3 x 3 elements of 1 m, cut by an oblique plane.
Scene bar() {
  Scene scene = block(tree_plugins(), "tm-faure", {8, 3, 3}, {8, 3, 3},
                      {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}});
  scene.events = {divide({4.1, 1.4, 1.6}, normal)};
  return scene;
}

Scene ball() {
  Scene scene = bar();
  fill(scene, sphere_surface({4, 1.5, 1.5}, 1.2, 4), 0.4);
  return scene;
}

Load pressure(double value) {
  Load load;
  load.kind = Load::Kind::pressure;
  load.pressure = value;
  return load;
}

/// The sum of the forces of all loads on the piece that lies on a side of the plane.
Vec3 sum_beyond(BuiltScene& built, bool above) {
  Body& body = built.body();
  Vec3 total{};
  std::vector<Index> vertices;
  for (Index v = 0; v < body.attributes().vertex_count(); ++v)
    if (body.complex().exists(0, v)) vertices.push_back(v);
  const Selection beyond{Selection::Nearest{plus({4.1, 1.4, 1.6}, scaled(above ? 1 : -1, normal))},
                         "/"};
  const Index island = body.islands().of(built.selector().elements_now(
      in_frame(beyond, built.frame()), body.attributes().position().rows())[0]);
  const std::vector<Vec3> forces = body.forces_at(vertices, 0);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (body.islands().of(element_of(body.complex().dart_of(0, vertices[i]))) == island)
      total = plus(total, forces[i]);
  return total;
}

/// The area vector of the lip below the plane.
Vec3 area_of_lip(OpenScene& open) {
  const Frame surface = open.side();
  Vec3 sum{};
  for (std::size_t t = 0; t < surface.cells.size(); ++t) {
    const auto corner = [&](int i) { return surface.points[surface.cells[t][i]]; };
    const Vec3 area = scaled(0.5, cross(minus(corner(1), corner(0)), minus(corner(2), corner(0))));
    if (surface.cell_fields.back().ids[t] != 0 && dot(area, normal) > 0) sum = plus(sum, area);
  }
  return sum;
}

// On a closed surface a pressure has no resultant: on a piece it is that which its lip lacks.
TEST(BladeLoads, APressureActsOnTheSurfaceOfPiecesAndNotOnLips) {
  for (Scene scene : {bar(), ball()}) {
    scene.loads = {pressure(100)};
    scene.output.surface = true;
    scene.events.push_back(divide({4.1, 1.4, 1.6}, {0.2, 1, 0.1}));
    OpenScene open(scene);
    open.events.fire(0, 0);
    const Vec3 area = area_of_lip(open);
    ASSERT_GT(dot(area, normal), 1);
    for (const bool above : {false, true}) {
      const Vec3 expected = scaled(above ? -100 : 100, area);
      EXPECT_LT(norm(minus(sum_beyond(open.built, above), expected)), 1e-9 * norm(expected));
    }
    open.events.fire(1, 0);  // copies are divided again
    EXPECT_EQ(open.built.body().islands().existing(), 4u);
    Vec3 total{};
    for (const auto& term : open.built.body().loads())
      for (const Vec3& f : forces_of_term(open.built.body(), *term, 0)) total = plus(total, f);
    EXPECT_LT(norm(total), 1e-7 * norm(area));
  }
}

TEST(BladeLoads, ATractionIsDividedByArea) {
  Scene scene = bar();
  Load load;
  load.kind = Load::Kind::traction;
  load.value = {0, 30, 7};
  load.where = at({any, any, 3});
  scene.loads = {load};
  OpenScene open(scene);
  open.events.fire(0, 0);
  // The plane meets the top where x = 4.1 - (0.3 (y - 1.4) + 0.6 (3 - 1.6)), 3.23 in the mean.
  const double below = 3 * (4.1 - 0.3 * 0.1 - 0.6 * 1.4);
  EXPECT_LT(norm(minus(sum_beyond(open.built, false), scaled(below, load.value))), 1e-9);
  EXPECT_LT(norm(minus(sum_beyond(open.built, true), scaled(24 - below, load.value))), 1e-9);
}

// Only parts of a surface are loaded: copies know which triangles were.
TEST(BladeLoads, OnlyLoadedTrianglesStayLoaded) {
  Scene scene = bar();
  scene.loads = {pressure(50)};
  scene.loads[0].where = at({any, any, 3});
  scene.events = {divide({4.1, 1.4, 3}, {0.2, 0.1, 1})};
  OpenScene open(scene);
  open.events.fire(0, 0);
  Vec3 total{};
  for (const auto& term : open.built.body().loads())
    for (const Vec3& f : forces_of_term(open.built.body(), *term, 0)) total = plus(total, f);
  EXPECT_LT(norm(minus(total, {0, 0, -50. * 24})), 1e-9);
}

// The step in which the body is cut books its work, too.
TEST(BladeLoads, TheLedgerBalances) {
  Scene scene = bar();
  scene.loads = {pressure(500)};
  scene.loads[0].ramp = {0, 0.3, true};
  scene.loads[0].where = at({any, any, 3});
  Load& traction = scene.loads.emplace_back();
  traction.kind = Load::Kind::traction;
  traction.value = {900, 0, 0};
  traction.where = at({8, any, any});
  hold(scene, at({0, any, any}), 7);
  scene.events[0].at = 0.31;
  scene.solver.dt = 1e-3;
  scene.solver.end = 0.6;
  Diagnostics diagnostics;
  Observer nobody;
  Simulation simulation(scene, tree_plugins(), diagnostics);
  simulation.run(nobody);
  const EnergyBalance e = simulation.built().dynamics().balance();
  EXPECT_GT(std::abs(e.work("pressure")), 1);
  EXPECT_GT(std::abs(e.work("loads")), 1);
  EXPECT_LT(std::abs(e.balance), 1e-4 * e.exchanged);
}

}  // namespace
}  // namespace suture::test::blade_loads_test
