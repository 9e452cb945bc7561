// SPDX-License-Identifier: GPL-3.0-or-later
//
// Contact in equilibria and in steps of implicit Euler.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "kernel/base/archive.hpp"
#include "tests/run/contact_scenes.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

double static_over_hertz(Index n) {
  Scene scene = hertz(n);
  scene.solver.integrator = "static";
  scene.solver.dt = 0.05;
  scene.solver.end = 0.2;
  return over_hertz(scene);
}

TEST(StaticContact, ASphereInABlockFollowsHertz) {
  const double coarse = std::abs(static_over_hertz(2) - 1),
               medium = std::abs(static_over_hertz(4) - 1);
  EXPECT_LT(medium, 0.08);
  EXPECT_LT(medium, coarse);
  if (std::getenv("SUTURE_FULL")) {
    EXPECT_LT(std::abs(static_over_hertz(10) - 1), 0.03);
  }
}

/// A block on a floor, which its sides hold against sliding.
Scene guided_block() {
  Scene scene = block_on_floor(2, {0, 0, -50}, 0);
  scene.gravity_ramp = {0, 0.5, true};
  for (const auto& [side, bits] : {std::pair{"x0", 1}, {"y0", 2}}) {
    Constraint& fix = scene.constraints.emplace_back();
    fix.where.what = Selection::Named{side};
    fix.components = static_cast<std::uint8_t>(bits);
  }
  return scene;
}

TEST(StaticContact, ABlockOnAFloorIsThatWhichCameToRest) {
  std::vector<Vec3> places[2];
  for (const bool is_static : {false, true}) {
    Scene scene = guided_block();
    if (is_static) {
      scene.solver.integrator = "static";
      scene.solver.dt = scene.solver.end = 1;
    } else {
      scene.solver.until_rest = scene.solver.automatic_damping = true;
      scene.solver.tolerance = 1e-8;
    }
    Diagnostics diagnostics;
    Simulation simulation(scene, host(), diagnostics);
    Observer nobody;
    simulation.run(nobody);
    Attributes& a = simulation.attributes();
    for (Index v = 0; v < a.vertex_count(); ++v)
      places[is_static].push_back(row(a.position().rows(), v));
    const double weight = 1000 * 0.4 * 0.4 * 0.2 * 50;
    EXPECT_NEAR(simulation.contact()->loads()[0].force[2], -weight, 1e-5 * weight);
  }
  double sunk = 0, apart = 0;
  for (std::size_t v = 0; v < places[0].size(); ++v) {
    sunk = std::max(sunk, 0.2 - places[0][v][2]);
    apart = std::max(apart, norm(minus(places[0][v], places[1][v])));
  }
  EXPECT_GT(sunk, 0.005);
  EXPECT_LT(apart, 2e-4 * 0.1) << "of an edge; gaps are below 1e-4";
}

TEST(ImplicitContact, ABlockFallsOntoAFloorAndStays) {
  Scene scene = block_on_floor(2, {0, 0, -9.81}, 0.5);
  scene.mesh.box->origin[2] = 0.05;
  scene.solver.integrator = "implicit-euler";
  scene.solver.dt = 5e-3;
  scene.solver.end = 1;
  Diagnostics diagnostics;
  Simulation simulation(scene, host(), diagnostics);
  Observer nobody;
  for (int i = 1; i <= 40; ++i) {
    simulation.run_to(0.025 * i, nobody);
    for (const double gap : simulation.contact()->gaps(simulation.time()))
      if (!std::isnan(gap)) {
        EXPECT_GT(gap, -1e-4 * 0.1) << "t = " << simulation.time();
      }
  }
  const EnergyBalance books = simulation.built().dynamics().balance();
  EXPECT_LT(books.kinetic, 1e-3 * books.work("gravity"));
  EXPECT_LT(books.work("contact"), -0.1 * books.work("gravity")) << "the impact";
  EXPECT_LT(books.balance, 0.02 * books.exchanged);
}

TEST(ImplicitContact, ARollbackRepeatsTheSameBits) {
  Scene scene = block_on_floor(2, on_slope(0.3, 1.5), 0.3);
  scene.solver.integrator = "implicit-euler";
  scene.solver.dt = 0.02;
  scene.solver.end = 1;
  Diagnostics diagnostics;
  Simulation simulation(scene, host(), diagnostics);
  Observer nobody;
  simulation.run_to(0.2, nobody);
  Dynamics& dynamics = simulation.built().dynamics();
  StateBuffer kept;
  kept.save(dynamics);
  const double time = dynamics.time();
  const auto finish = [&] {
    for (int i = 1; i <= 10; ++i) dynamics.step(0.02, time + 0.02 * i);
    const Column& x = simulation.attributes().position();
    std::vector<double> all(x.rows(), x.rows() + 4 * std::size_t{x.size()});
    all.push_back(simulation.contact()->friction_work());
    all.push_back(dynamics.balance().work("contact"));
    return all;
  };
  const std::vector<double> first = finish();
  EXPECT_LT(first[first.size() - 2], 0);
  kept.load(dynamics);
  EXPECT_EQ(finish(), first);
}

TEST(ImplicitContact, FrictionHoldsOrSlidesByItsCoefficient) {
  double moved[2];
  for (const double part : {0.98, 1.02}) {
    Scene scene = block_on_floor(2, on_slope(0.3, part), 0.3);
    scene.solver.integrator = "implicit-euler";
    scene.gravity_ramp = {0, 0.5, true};
    scene.solver.dt = 0.05;
    scene.solver.end = 6;
    scene.solver.damping = 2;
    Diagnostics diagnostics;
    Simulation simulation(scene, host(), diagnostics);
    Observer nobody;
    simulation.run_to(3, nobody);
    const double before = mean_x(simulation);
    simulation.run_to(6, nobody);
    moved[part > 1] = mean_x(simulation) - before;
  }
  EXPECT_LT(std::abs(moved[0]), 3 * 1e-6 * 0.4);
  const double rigid =
      9.81 * (std::sin(1.02 * std::atan(0.3)) - 0.3 * std::cos(1.02 * std::atan(0.3))) / 2;
  EXPECT_GT(moved[1], 0.9 * 3 * rigid);
}

}  // namespace
}  // namespace suture::test
