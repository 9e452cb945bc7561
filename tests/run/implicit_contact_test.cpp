// SPDX-License-Identifier: GPL-3.0-or-later
//
// Contact in equilibria and in steps of implicit Euler.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "kernel/base/archive.hpp"
#include "kernel/contact/contact.hpp"
#include "kernel/contact/piece_overlap.hpp"
#include "tests/base/sanitizer.hpp"
#include "tests/run/contact_scenes.hpp"
#include "tests/run/events.hpp"
#include "tests/run/test_simulation.hpp"

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
      find_equilibrium(scene, 1);
    } else {
      scene.solver.until_rest = scene.solver.automatic_damping = true;
      scene.solver.tolerance = 1e-8;
    }
    TestSimulation simulation(scene);
    simulation.run();
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

/// The mean way of the nodes at the top in an equilibrium, m.
double way_of_top(Scene scene) {
  find_equilibrium(scene, 1);
  TestSimulation simulation(scene);
  simulation.run();
  Attributes& a = simulation.attributes();
  double top = 0, way = 0;
  for (Index v = 0; v < a.vertex_count(); ++v) top = std::max(top, a.rest().get(v, 2));
  int count = 0;
  for (Index v = 0; v < a.vertex_count(); ++v)
    if (a.rest().get(v, 2) > top - 1e-9) {
      way += a.position().get(v, 2) - a.rest().get(v, 2);
      ++count;
    }
  return way / count;
}

// A body that lies somewhere sinks as if it were held there, however small the load is.
TEST(StaticContact, AddsNoComplianceAtAnyLoad) {
  for (const double g : {0.02, 2.0, 50.0})
    for (const Index n : {2, 4})
      for (const bool is_stack : {false, true}) {
        const TemporaryFolder folder;
        Scene lying = block_on_floor(n, {0, 0, -g}, 0);
        if (is_stack)  // nu = 0: the halves do not slide on each other
          lying.models[0].parameters[1] = 0;
        Scene held = lying;
        for (Scene* scene : {&lying, &held})
          for (const auto& [side, bits] : {std::pair{"x0", 1}, {"y0", 2}}) {
            Constraint& fix = scene->constraints.emplace_back();
            fix.where.what = Selection::HalfSpace{
                {0, 0, 0}, {side[0] == 'x' ? -1.0 : 0, side[0] == 'y' ? -1.0 : 0, 0}};
            fix.components = static_cast<std::uint8_t>(bits);
          }
        held.contact.obstacles.clear();
        Constraint& floor = held.constraints.emplace_back();
        floor.where.what = Selection::HalfSpace{{0, 0, 0}, {0, 0, -1}};
        floor.components = 4;
        if (is_stack) {
          lying.contact.pieces = true;
          use_boxes(lying, folder,
                    {{{0, 0, 0}, {0.4, 0.4, 0.1}, {2 * n, 2 * n, n / 2}, {1, 1, 1}},
                     {{0, 0, 0.1}, {0.4, 0.4, 0.1}, {2 * n, 2 * n, n / 2}, {1, 1, 1}}});
        }
        const double expected = way_of_top(held);
        EXPECT_NEAR(way_of_top(lying) / expected, 1, 3e-3)
            << g << " m/s^2, " << n << (is_stack ? " stack" : " block");
      }
}

/// To the bit, and with friction in these steps.
void expect_the_same_after_a_rollback(Simulation& simulation, int steps, double dt) {
  Dynamics& dynamics = simulation.built().dynamics();
  StateBuffer kept;
  kept.save(dynamics);
  const std::vector<double> first = after_steps(simulation, steps, dt);
  EXPECT_LT(first[first.size() - 2], 0) << "friction";
  kept.load(dynamics);
  EXPECT_EQ(after_steps(simulation, steps, dt), first);
}

TEST(ImplicitContact, ABlockFallsOntoAFloorAndStays) {
  Scene scene = block_on_floor(2, {0, 0, -9.81}, 0.5);
  scene.mesh.box->origin[2] = 0.05;
  scene.solver.integrator = "implicit-euler";
  scene.solver.dt = 5e-3;
  scene.solver.end = 1;
  TestSimulation simulation(scene);
  for (int i = 1; i <= 40; ++i) {
    simulation.run_to(0.025 * i);
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
  TestSimulation simulation(scene);
  simulation.run_to(0.2);
  expect_the_same_after_a_rollback(simulation, 10, 0.02);
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
    TestSimulation simulation(scene);
    simulation.run_to(3);
    const double before = mean_x(simulation);
    simulation.run_to(6);
    moved[part > 1] = mean_x(simulation) - before;
  }
  EXPECT_LT(std::abs(moved[0]), 3 * 1e-6 * 0.4);
  const double rigid = sliding_speed(0.3, 1.02, 2);
  EXPECT_GT(moved[1], 0.9 * 3 * rigid);
}

/// Holds the component along an axis of the nodes of a plane at right angles to it.
Constraint& hold_face(Scene& scene, std::size_t axis, double at) {
  Constraint& fix = scene.constraints.emplace_back();
  Selection::Plane plane{{}, {}, 1e-6};
  plane.point[axis] = at;
  plane.normal[axis] = 1;
  fix.where.what = plane;
  fix.where.path = "/constraints";
  fix.components = static_cast<std::uint8_t>(1u << axis);
  return fix;
}

/// Blocks whose meshes do not match.
std::vector<BoxOptions> stack(std::initializer_list<Index> cells) {
  std::vector<BoxOptions> boxes;
  for (const Index n : cells)
    boxes.push_back({.origin = {0, 0, 0.2 * static_cast<double>(boxes.size())},
                     .size = {0.4, 0.4, 0.2},
                     .cells = {2 * n, 2 * n, n}});
  return boxes;
}

/// The largest distance by which pieces are in each other, of an edge.
double overlap_of_pieces(Simulation& simulation) {
  const auto& contact = dynamic_cast<const Contact&>(*simulation.contact());
  double depth = 0;
  for (const PieceOverlap& overlap :
       find_piece_overlaps(contact, simulation.complex(), simulation.attributes(), 0))
    depth = std::max(depth, overlap.depth);
  return depth / contact.mean_edge();
}

TEST(StaticPieces, AStackCarriesItsWeight) {
  for (const double friction : {0.5, 0.0}) {
    TemporaryFolder folder;
    Scene scene = block_on_floor(1, {0, 0, -9.81}, friction);
    use_boxes(scene, folder, stack({2, 3, 2}));
    scene.contact.pieces = true;
    scene.contact.friction = friction;
    if (friction == 0) {
      hold_face(scene, 0, 0);
      hold_face(scene, 1, 0);
    }
    find_equilibrium(scene, 1);
    TestSimulation simulation(scene);
    simulation.run();
    const double weight = 3 * 1000 * 0.4 * 0.4 * 0.2 * 9.81;
    EXPECT_NEAR(simulation.contact()->loads()[0].force[2], -weight, 1e-6 * weight);
    EXPECT_LT(overlap_of_pieces(simulation), 1e-4);
  }
}

/// Strains along z of all elements, of two blocks pressed together.
TEST(StaticPieces, MeshesThatDoNotMatchCarryAUniformPressure) {
  for (const auto& cells : {std::array<Index, 2>{2, 3}, {3, 2}}) {
    TemporaryFolder folder;
    Scene scene = block_on_floor(1, {}, 0);
    scene.contact.obstacles.clear();
    use_boxes(scene, folder, stack({cells[0], cells[1]}));
    for (const std::size_t axis : {0, 1, 2}) hold_face(scene, axis, 0);
    Constraint& pressed = hold_face(scene, 2, 0.4);
    pressed.translation = {0, 0, -0.008};
    pressed.ramp = {0, 1, true};
    pressed.moves = true;
    scene.contact.pieces = true;
    find_equilibrium(scene, 1);
    TestSimulation simulation(scene);
    simulation.run();
    Attributes& a = simulation.attributes();
    double worst = 0;
    for (Index v = 0; v < a.vertex_count(); ++v) {
      const double expected = -0.02 * a.rest().get(v, 2);
      worst =
          std::max(worst, std::abs(a.position().get(v, 2) - a.rest().get(v, 2) - expected) / 0.008);
    }
    EXPECT_LT(worst, 1e-3);
  }
}

TEST(ImplicitPieces, FrictionHoldsOrSlidesByItsCoefficient) {
  double moved[2];
  for (const double part : {0.98, 1.02}) {
    TemporaryFolder folder;
    Scene scene = block_on_floor(1, on_slope(0.3, part), 0.3, 1e6);
    scene.contact.obstacles.clear();
    use_boxes(scene, folder,
              {{.origin = {0, -0.2, 0}, .size = {1.2, 0.8, 0.2}, .cells = {2, 1, 1}},
               {.origin = {0.62, 0, 0.2}, .size = {0.4, 0.4, 0.2}, .cells = {3, 3, 2}}});
    hold_face(scene, 2, 0).components = 7;
    scene.contact.pieces = true;
    scene.contact.friction = 0.3;
    scene.gravity_ramp = {0, 0.5, true};
    scene.solver.integrator = "implicit-euler";
    scene.solver.dt = 0.05;
    scene.solver.end = 4;
    scene.solver.damping = 2;
    TestSimulation simulation(scene);
    simulation.run_to(2);
    const double before = mean_x(simulation);
    simulation.run_to(4);
    moved[part > 1] = (mean_x(simulation) - before) * 60 / 48;  // of the nodes of both
    EXPECT_LT(overlap_of_pieces(simulation), 1e-4);
  }
  EXPECT_LT(std::abs(moved[0]), 2 * 1e-6 * 0.4);
  const double rigid = sliding_speed(0.3, 1.02, 2);
  EXPECT_NEAR(moved[1], 2 * rigid, 0.1 * 2 * rigid);
}

/// A block that sticks to a plate below and to one that moves by `shear` along x while it presses
/// it by 2 %, with a cut like stairs.
Scene pressed_lips(Index n, double friction, double shear) {
  Scene scene = block_on_floor(n, {}, 0);
  scene.contact.obstacles.clear();
  scene.contact.pieces = true;
  scene.contact.friction = friction;
  hold_face(scene, 2, 0).components = 7;
  Constraint& moved = hold_face(scene, 2, 0.2);
  moved.components = 7;
  moved.translation = {shear, 0, -0.004};
  moved.ramp = {0, 0.5, true};
  moved.moves = true;
  Event cut = event_of(CutPlane{{0, 0, 0.13}, {0.3, 0, 1}});
  cut.rest_shape = true;
  scene.events = {cut};
  return scene;
}

TEST(StaticPieces, LipsAreWhereTheyComeToRest) {
  std::vector<double> places[2];
  for (const bool is_static : {false, true}) {
    Scene scene = pressed_lips(3, 0, 0);
    if (is_static) {
      find_equilibrium(scene, 0.5);
    } else {
      scene.solver.until_rest = scene.solver.automatic_damping = true;
      scene.solver.tolerance = 1e-4;
    }
    TestSimulation simulation(scene);
    EXPECT_EQ(simulation.run().faces_cut, 42u);
    EXPECT_GT(simulation.contact()->touches().size(), 20u);
    places[is_static] = position_rows(simulation);
  }
  double apart = 0;
  for (std::size_t i = 0; i < places[0].size(); ++i)
    apart = std::max(apart, std::abs(places[0][i] - places[1][i]));
  EXPECT_LT(apart, 1e-3 * 0.0667) << "of an edge; gaps are below 1e-4, and forces rest at 1e-4";
}

// In the corners of stairs in two directions three faces are equally near.
TEST(StaticPieces, LipsWithFrictionCarryWhatTheUncutBlockCarries) {
  double forces[2];
  for (const bool is_cut : {false, true}) {
    Scene scene = pressed_lips(3, 0.05, 0);
    std::get<CutPlane>(scene.events[0].what) = {{0.21, 0.22, 0.101}, {0.3, 0.2, 1}};
    if (!is_cut) scene.events.clear();
    find_equilibrium(scene, 0.5);
    TestSimulation simulation(scene);
    EXPECT_EQ(simulation.run().faces_cut != 0, is_cut);
    forces[is_cut] = simulation.built().dynamics().balance().work("prescribed");
  }
  EXPECT_NEAR(forces[1], forces[0], 0.01 * std::abs(forces[0]));
}

TEST(StaticPieces, ABodyTouchesItself) {
  Scene scene = bent_u(true);
  find_equilibrium(scene, 0.5);
  EXPECT_NEAR(slot_of(scene), 0, 0.05 * 0.05);
}

TEST(StaticPieces, WhatNothingTouchesIsNamed) {
  Scene scene = block_on_floor(1, {0, 0, -9.81}, 0);
  scene.mesh.box->origin[2] = 0.05;
  scene.mesh.box->cells = {1, 1, 1};
  scene.contact.pieces = true;
  find_equilibrium(scene, 1);
  TestSimulation simulation(scene);
  const std::string text = error_of(simulation);
  EXPECT_NE(text.find("a piece of 1 element (the first: element 0) is free to move and turn in "
                      "every direction, unless contact holds it"),
            std::string::npos)
      << text;
}

Scene sheared_lips(Index n) {
  Scene scene = pressed_lips(n, 0.2, 0.006);
  scene.solver.integrator = "implicit-euler";
  scene.solver.dt = 0.05;
  scene.solver.end = 0.5;
  return scene;
}

TEST(ImplicitPieces, HaveTheSameBitsAfterARollback) {
  TestSimulation simulation(sheared_lips(2));
  simulation.run_to(0.25);
  expect_the_same_after_a_rollback(simulation, 4, 0.05);
}

TEST(ImplicitPieces, HaveTheSameBitsForAnyNumberOfThreads) {
  std::vector<double> first;
  for (const unsigned threads : thread_counts()) {
    Scene scene = sheared_lips(11);  // enough elements for a second thread
    scene.solver.threads = threads;
    TestSimulation simulation(scene);
    simulation.run_to(0.05);  // cuts
    const std::vector<double> all = after_steps(simulation, 1, 0.05);
    EXPECT_LT(all[all.size() - 2], 0) << "friction";
    if (threads == 1) first = all;
    EXPECT_EQ(all, first) << threads << " threads";
  }
}

/// One that falls by up to three of its edges in a step: rejected steps keep it from passing.
TEST(ImplicitPieces, FastOnesDoNotPassThroughEachOther) {
  TemporaryFolder folder;
  Scene scene = block_on_floor(1, {0, 0, -100}, 0, 1e6);
  scene.contact.obstacles.clear();
  use_boxes(scene, folder,
            {{.origin = {0, 0, 0}, .size = {0.4, 0.4, 0.1}, .cells = {4, 4, 1}},
             {.origin = {0.03, 0.04, 0.4}, .size = {0.3, 0.3, 0.1}, .cells = {3, 3, 1}}});
  hold_face(scene, 2, 0).components = 7;
  scene.contact.pieces = true;
  scene.contact.friction = 0.3;
  scene.solver.integrator = "implicit-euler";
  scene.solver.dt = 0.04;
  scene.solver.end = 0.4;
  TestSimulation simulation(scene);
  simulation.run();
  EXPECT_LT(overlap_of_pieces(simulation), 1e-4);
  Attributes& a = simulation.attributes();
  for (Index v = 50; v < a.vertex_count(); ++v) EXPECT_GT(a.position().get(v, 2), 0.05);
}

/// The upper half of a block that is cut while it lies on a floor, in 0.3 s.
TEST(ImplicitPieces, LipsOfACutTouchFromTheNextStepOn) {
  double lowest[2];
  for (const bool pieces : {false, true}) {
    Scene scene = block_on_floor(2, {0, 0, -9.81}, 0.5);
    scene.contact.pieces = pieces;
    scene.contact.friction = 0.5;
    scene.solver.integrator = "implicit-euler";
    scene.solver.dt = 0.01;
    scene.solver.end = 0.3;
    scene.events = {event_of(CutPlane{{0, 0, 0.1}, {0, 0, 1}}, 0.1)};
    TestSimulation simulation(scene);
    EXPECT_EQ(simulation.run().faces_cut, 16u);
    if (pieces) {
      EXPECT_LT(overlap_of_pieces(simulation), 1e-4);
    }
    Attributes& a = simulation.attributes();
    lowest[pieces] = 1;
    for (Index v = 0; v < a.vertex_count(); ++v)
      if (simulation.complex().dart_of(0, v) / 24 >= 16)
        lowest[pieces] = std::min(lowest[pieces], a.position().get(v, 2));
  }
  EXPECT_LT(lowest[0], 0.05);
  EXPECT_GT(lowest[1], 0.09);
}

}  // namespace
}  // namespace suture::test
