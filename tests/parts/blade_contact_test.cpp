// SPDX-License-Identifier: GPL-3.0-or-later
//
// Contact of bodies that are cut along blades: lips touch what the rest of the surface does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "kernel/base/rows.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/run/simulation.hpp"
#include "tests/parts/blade_event.hpp"
#include "tests/run/equilibrium.hpp"

namespace suture::test::blade_contact_test {
namespace {

const Vec3 oblique{1, 0.15, 0.4};

/// A slab of 8 x 4 x 3 elements of 1 m on a table, cut by an oblique plane at 0.3 s.
Scene slab() {
  Scene scene = block(tree_plugins(), "tm-faure", {8, 4, 3}, {8, 4, 3},
                      {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}});
  scene.gravity = {0, 0, -2};
  scene.contact.obstacles = {
      {"table", "/contact/obstacles/0", HalfSpace{{0, 0, 0}, {0, 0, 1}}, {}, 0.4}};
  scene.solver.damping = 3;
  scene.solver.dt = 2e-3;
  Event cut = divide({4.1, 2.1, 1.4}, oblique);
  cut.at = 0.3;
  scene.events = {cut};
  return scene;
}

struct SlabRun {
  explicit SlabRun(const Scene& scene) : simulation(scene, tree_plugins(), diagnostics) {}
  Attributes& attributes() { return simulation.attributes(); }
  double mass(Index v) { return attributes().mass().get(v, 0); }
  Vec3 momentum() {
    Vec3 sum{};
    for (Index v = 0; v < attributes().vertex_count(); ++v)
      sum = plus(sum, scaled(mass(v), row(attributes().velocity().rows(), v)));
    return sum;
  }
  double total_mass() {
    double sum = 0;
    for (Index v = 0; v < attributes().vertex_count(); ++v) sum += mass(v);
    return sum;
  }
  /// The least of a function over the points of the surface.
  template <class Of>
  double least(Of of) {
    const Embedding& embedding = simulation.built().embedding();
    double least = 1e9;
    for (const auto& triangle : embedding.triangles)
      for (const Index p : triangle) {
        Vec3 place;
        for (std::size_t c = 0; c < 3; ++c)
          place[c] = embedding.points.value(p, attributes().position().rows(), 4, c);
        least = std::min(least, of(place));
      }
    return least;
  }
  double lowest() {
    return least([](const Vec3& place) { return place[2]; });
  }
  Index islands() { return simulation.built().body().islands().existing(); }

  Diagnostics diagnostics;
  Observer nobody;
  Simulation simulation;
};

TEST(BladeContact, TheForceOfATableIsTheChangeOfMomentum) {
  Scene scene = slab();
  scene.solver.damping = 0;
  SlabRun run(scene);
  run.simulation.run_to(0.2, run.nobody);
  const double weight = 2 * run.total_mass();
  while (run.simulation.time() < 0.8) {
    const Vec3 before = run.momentum();
    const double dt = run.simulation.next_dt();
    run.simulation.advance({{}, 1}, run.nobody);
    const Vec3 on = scaled(-1, run.simulation.contact()->loads()[0].force);
    const Vec3 change = minus(run.momentum(), before);
    EXPECT_LT(norm(minus(change, scaled(dt, minus(on, {0, 0, weight})))), 1e-9 * weight)
        << run.simulation.time();
    ASSERT_GT(run.lowest(), -1e-4) << run.simulation.time();
  }
  EXPECT_EQ(run.islands(), 2u);
}

TEST(BladeContact, PiecesRestOnATableWithTheirWeight) {
  for (const char* law : {"impulses", "penalty", "implicit-euler", "static"}) {
    Scene scene = slab();
    const bool yields = std::string(law) == "penalty";
    if (yields) {
      scene.contact.penalty = true;
      scene.contact.obstacles[0].friction = 0;
    } else if (std::string(law) != "impulses") {
      scene.solver.integrator = law;
      scene.solver.dt = 0.05;
    }
    SlabRun run(scene);
    run.simulation.run_to(4, run.nobody);
    EXPECT_EQ(run.islands(), 2u);
    const double weight = 2 * run.total_mass();
    EXPECT_NEAR(run.simulation.contact()->loads()[0].force[2], -weight, 0.01 * weight) << law;
    EXPECT_GT(run.lowest(), yields ? -0.5 : -1e-4) << law;
    const EnergyBalance e = run.simulation.built().dynamics().balance();
    if (scene.solver.integrator != law) {
      EXPECT_LT(std::abs(e.balance), 0.003 * e.exchanged) << law;
    }
  }
}

/// The numbers of islands asleep that a run reports.
struct Asleep : Observer {
  void on_message(const std::string& text) override {
    const auto at = text.find(" s: ");
    if (text.find("asleep") != std::string::npos) numbers.push_back(std::stoi(text.substr(at + 4)));
  }
  std::vector<int> numbers;
};

/// The half that leans on the other one is lifted, and falls on it while it sleeps.
Scene falling_half() {
  Scene scene = slab();
  scene.events[0].at = 0;
  scene.contact.pieces = true;
  scene.solver.sleep_acceleration = 0.02;
  scene.solver.sleep_velocity = 1e-3;
  scene.solver.end = 60;
  return scene;
}

void lift(SlabRun& run, double height) {
  Body& body = run.simulation.built().body();
  run.simulation.change_motion([&](Attributes& a) {
    for (Index v = 0; v < a.vertex_count(); ++v)
      if (body.islands().of(body.complex().dart_of(0, v) / 24) == 1)
        a.position().set(v, 2, a.position().get(v, 2) + height);
  });
}

TEST(BladeContact, AHalfThatFallsOnASleepingOneWakesIt) {
  SlabRun run(falling_half());
  Asleep listener;
  run.simulation.run_to(0.01, listener);
  ASSERT_EQ(run.islands(), 2u);
  lift(run, 5);
  run.simulation.run_to(7, listener);
  ASSERT_FALSE(listener.numbers.empty());
  EXPECT_EQ(listener.numbers.back(), 1);
  const double weight = 2 * run.total_mass();
  // 11 to 31 s, as rounding has it.
  for (double time = 8; listener.numbers.back() != 2 && time <= 60; ++time)
    run.simulation.run_to(time, listener);
  EXPECT_EQ(listener.numbers.back(), 2) << "both sleep, each on the other";
  EXPECT_NE(std::ranges::find(listener.numbers, 0), listener.numbers.end()) << "it has woken";
  EXPECT_FALSE(run.simulation.contact()->presses().empty());
  EXPECT_NEAR(run.simulation.contact()->loads()[0].force[2], -weight, 0.02 * weight);
}

/// A bar that is held at both ends; a plate 0.8 m thick goes down through it, behind its edge.
Scene bar_and_plate() {
  Scene scene = slab();
  scene.gravity = {};
  hold(scene, at({0, any, any}), 7);
  hold(scene, at({8, any, any}), 7);
  Obstacle knife{"knife", "/contact/obstacles/0", Box{{3.9, -1, 3.1}, {4.7, 5, 8}}};
  knife.motion.stations = {{0.1, {}, 0}, {1.1, {0, 0, -3.6}, 0}};
  scene.contact.obstacles = {knife};
  CutBlade cut;
  cut.carried = CutBlade::Carried{0, "knife", {{4.3, -1, 3.05}, {4.3, 5, 3.05}}};
  cut.stations.resize(1);
  cut.along_blade = true;
  scene.events[0] = {.what = cut, .path = "/events/0"};
  scene.solver.end = 1.2;
  return scene;
}

TEST(BladeContact, AnObstacleDoesNotPushWhatItsBladeCuts) {
  SlabRun run(bar_and_plate());
  while (run.simulation.time() < 1.1) {
    run.simulation.advance({{}, 1}, run.nobody);
    ASSERT_EQ(norm(run.simulation.contact()->loads()[0].force), 0);
  }
  EXPECT_EQ(run.islands(), 2u);
}

// What pushes the same body meanwhile goes on doing so.
TEST(BladeContact, OtherObstaclesPushMeanwhile) {
  Scene scene = bar_and_plate();
  Obstacle ball{"ball", "/contact/obstacles/1", Sphere{{1.6, 2, 4}, 1}};
  ball.motion.stations = {{0, {}, 0}, {0.5, {0, 0, -0.4}, 0}};
  scene.contact.obstacles.push_back(ball);
  SlabRun run(scene);
  run.simulation.run_to(1.1, run.nobody);
  EXPECT_EQ(run.islands(), 2u);
  EXPECT_GT(run.simulation.contact()->loads()[1].force[2], 100);
  EXPECT_NEAR(run.least([](const Vec3& place) {
    return norm(minus(place, {1.6, 2, 3.6})) - 1;
  }),
              0, 1e-6);
}

// Sweeps over lips end before those over a table; what touches both must not be left in the table.
TEST(BladeContact, LipsPushNothingIntoATable) {
  Scene scene = slab();
  scene.contact.pieces = true;
  scene.contact.friction = 0.3;
  Obstacle ball{"ball", "/contact/obstacles/1", Sphere{{-1.5, 2, 2}, 1.5}};
  ball.motion.stations = {{0.3, {}, 0}, {0.8, {0.5, 0, -0.3}, 0}};
  scene.contact.obstacles.push_back(ball);
  SlabRun run(scene);
  run.simulation.run_to(0.2, run.nobody);
  while (run.simulation.time() < 0.8) {
    run.simulation.advance({{}, 1}, run.nobody);
    ASSERT_GT(run.lowest(), -1e-6) << run.simulation.time();
  }
  EXPECT_EQ(run.islands(), 2u);
  EXPECT_LT(run.simulation.contact()->loads()[1].force[0], -100);
}

// Lips that approach limit the step, by what is near now: a resumed run seeks again what may touch.
TEST(BladeContact, AResumedRunTakesTheSameSteps) {
  Scene scene = slab();
  scene.mesh.box.reset();
  scene.mesh.voxels = VoxelOptions{.layers = 2, .rows = {"##.##.##", "##.##.##", "##.##.##"}};
  scene.models[0].parameters[0] = 1e6;  // E
  scene.models[0].parameters[2] = 200;  // rho
  scene.gravity = {0, -10, 0};
  scene.contact.pieces = true;
  scene.contact.friction = 0.3;
  scene.contact.obstacles = {
      {"left", "/contact/obstacles/0", HalfSpace{{4, -7, 0}, {0.4, 1, 0}}, {}, 0.3},
      {"right", "/contact/obstacles/1", HalfSpace{{4, -7, 0}, {-0.4, 1, 0}}, {}, 0.3}};
  scene.solver.dt.reset();
  scene.solver.damping = 0.2;
  scene.solver.end = 2;
  scene.events[0] = divide({4.1, 1.6, 1}, {0.1, 1, 0.2});
  scene.events[0].at = 0.02;
  SlabRun whole(scene);
  whole.simulation.run_to(1.1, whole.nobody);
  for (const double until : {1.3, 1.5, 1.7}) {
    SlabRun resumed(scene);
    resumed.simulation.load(whole.simulation.save());
    for (SlabRun* run : {&whole, &resumed}) run->simulation.run_to(until, run->nobody);
    EXPECT_EQ(whole.momentum(), resumed.momentum()) << until;
  }
}

/// How far the right arm of a fork has been pushed, whose left arm is pulled 0.6 m past it.
double pushed_arm(bool self) {
  Scene scene = slab();
  scene.mesh.box.reset();
  scene.mesh.voxels = VoxelOptions{.layers = 2, .rows = {"#.#", "#.#", "#.#", "#.#", "###"}};
  scene.gravity = {};
  scene.contact.obstacles.clear();
  scene.contact.pieces = true;
  scene.contact.self = self;
  scene.solver.damping = 5;
  scene.solver.end = 4;
  scene.events[0].at = 4;
  hold(scene, at({any, 0, any}), 7);
  hold(scene, within({-0.1, 4.9, -1}, {1.1, 5.1, 3}), 1, {1.6, 0, 0});
  SlabRun run(scene);
  run.simulation.run_to(3, run.nobody);
  const double* x = run.attributes().position().rows();
  double least = 1e9;
  for (Index v = 0; v < run.attributes().vertex_count(); ++v) {
    const Vec3 rest = row(run.attributes().rest().rows(), v);
    if (rest[0] > 1.9 && rest[1] > 4.9) least = std::min(least, row(x, v)[0] - rest[0]);
  }
  return least;
}

TEST(BladeContact, OnePieceTouchesItselfIfAsked) {
  EXPECT_GT(pushed_arm(true), 0.5);
  EXPECT_LT(pushed_arm(false), 0.05);
}

/// A block of 4 x 4 x 6 elements, held at its foot, that a plate presses by 2 %.
Scene pressed_block(bool is_cut, double friction) {
  Scene scene = block(tree_plugins(), "tm-faure", {4, 4, 6}, {4, 4, 6},
                      {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}});
  hold(scene, at({any, any, 0}), 7);
  Obstacle plate{"plate", "/contact/obstacles/0", HalfSpace{{0, 0, 6}, {0, 0, -1}}};
  plate.motion.stations = {{0.1, {}, 0}, {1.1, {0, 0, -0.12}, 0}};
  scene.contact.obstacles = {plate};
  scene.contact.pieces = true;
  scene.contact.friction = friction;
  scene.solver.damping = 5;
  scene.solver.end = 3;
  Event cut = divide({2.1, 1.9, 3.1}, {0.35, 0.15, 1});
  cut.at = is_cut ? 0.05 : 3;
  scene.events = {cut};
  return scene;
}

TEST(BladeContact, LipsCarryPressureAndSlide) {
  const auto force = [](bool is_cut, double friction) {
    SlabRun run(pressed_block(is_cut, friction));
    run.simulation.run_to(2.9, run.nobody);
    EXPECT_EQ(run.islands(), is_cut ? 2u : 1u);
    const EnergyBalance e = run.simulation.built().dynamics().balance();
    EXPECT_LT(std::abs(e.balance), 0.001 * e.exchanged);
    return run.simulation.contact()->loads()[0].force[2];
  };
  const double whole = force(false, 0), sticking = force(true, 1), sliding = force(true, 0);
  EXPECT_NEAR(sticking / whole, 1, 0.01);
  EXPECT_LT(sliding, 0.7 * whole);
  EXPECT_GT(sliding, 0.4 * whole);
}

TEST(BladeContact, LipsCarryPressureInEquilibriaAndImplicitSteps) {
  for (const char* solver : {"static", "implicit-euler"}) {
    const auto force = [&](bool is_cut, double friction) {
      Scene scene = pressed_block(is_cut, friction);
      scene.solver.integrator = solver;
      scene.solver.dt = 0.1;
      SlabRun run(scene);
      run.simulation.run_to(2, run.nobody);
      EXPECT_EQ(run.islands(), is_cut ? 2u : 1u);
      return run.simulation.contact()->loads()[0].force[2];
    };
    const double whole = force(false, 0);
    EXPECT_NEAR(force(true, 1) / whole, 1, 0.01) << solver;
    if (std::string(solver) == "static") continue;  // nothing would hold the upper half
    const double sliding = force(true, 0);
    EXPECT_LT(sliding, 0.7 * whole);
    EXPECT_GT(sliding, 0.4 * whole);
  }
}

/// A rod that has entered the top of a cube between its nodes, where a plane then makes points.
TEST(BladeContact, AnObstacleAtRestEasesOutWhatACutPutsIntoIt) {
  for (const double depth : {0.02, 0.05}) {
    double last = 0;
    for (const double dt : {0.02, 0.01, 0.005, 0.0025}) {
      Scene scene = block(tree_plugins(), "tm-faure", {1, 1, 1}, {2, 2, 2},
                          {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}});
      hold(scene, at({any, any, 0}), 7);
      Obstacle rod{"rod", "/contact/obstacles/0",
                   Capsule{{0.25, -2, 1.15 - depth}, {0.25, 3, 1.15 - depth}, 0.15}};
      scene.contact.obstacles = {rod};
      scene.solver.integrator = "implicit-euler";
      scene.solver.dt = dt;
      scene.events = {divide({0.26, 0.5, 0.5}, {1, 0.1, 0})};
      SlabRun run(scene);
      double largest = 0;
      for (int i = 1; i <= 10; ++i) {
        run.simulation.run_to(0.02 * i, run.nobody);
        largest = std::max(largest, run.simulation.built().dynamics().balance().kinetic);
      }
      EXPECT_GT(largest, 1e-9) << "J: the points come out, " << depth << " m, dt " << dt;
      EXPECT_LT(largest, 0.1) << "J, " << depth << " m, dt " << dt;
      if (last > 0) {
        EXPECT_LT(largest, 3 * last) << "J, " << depth << " m, dt " << dt;
      }
      last = largest;
      const double work = run.simulation.built().dynamics().balance().work("contact");
      EXPECT_LT(work, 0.5) << "J, " << depth << " m, dt " << dt;
    }
  }
}

/// Bars in a trough, cut at random while they fall on each other.
Scene pile(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any_part(0.2, 0.8);
  std::normal_distribution<double> any_direction;
  Scene scene = block(tree_plugins(), "tm-faure", {6, 4, 2}, {6, 4, 2},
                      {{"E", 1e5}, {"nu", 0.3}, {"rho", 200}});
  scene.gravity = {0, -10, 0};
  scene.contact.pieces = true;
  scene.contact.friction = 0.3;
  scene.contact.obstacles = {
      {"left", "/contact/obstacles/0", HalfSpace{{3, -1.5, 0}, {0.4, 1, 0}}, {}, 0.3},
      {"right", "/contact/obstacles/1", HalfSpace{{3, -1.5, 0}, {-0.4, 1, 0}}, {}, 0.3}};
  scene.solver.integrator = "implicit-euler";
  scene.solver.dt = 0.02;
  scene.solver.damping = 1;
  for (int i = 0; i < 3; ++i) {
    Vec3 normal;
    for (double& c : normal) c = any_direction(random);
    Event cut = divide({6 * any_part(random), 4 * any_part(random), 2 * any_part(random)}, normal);
    cut.at = 0.1 * i + 0.02;
    scene.events.push_back(cut);
  }
  return scene;
}

TEST(BladeContact, PilesOfPiecesSettleInImplicitSteps) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    SlabRun whole(pile(seed));
    whole.simulation.run_to(0.5, whole.nobody);
    EXPECT_GT(whole.islands(), 1u) << seed;
    SlabRun resumed(pile(seed));
    resumed.simulation.load(whole.simulation.save());
    double last = whole.simulation.built().dynamics().balance().work("contact");
    for (SlabRun* run : {&whole, &resumed}) run->simulation.run_to(0.8, run->nobody);
    EXPECT_EQ(whole.momentum(), resumed.momentum()) << seed;
    const EnergyBalance e = whole.simulation.built().dynamics().balance();
    EXPECT_LT(e.balance, 1e-3 * e.exchanged) << seed;
    EXPECT_LT(e.work("contact") - last, 1e-3 * e.exchanged) << seed;
  }
}

/// A hand that presses a compliant ball into the slab, beside the cut and across it.
Scene probed_slab(double mass) {
  Scene scene = slab();
  scene.solver.damping = 0;
  scene.solver.dt = 1e-3;
  Obstacle ball{"probe", "/contact/obstacles/1", Sphere{{3.5, 2, 4.6}, 1.5}};
  ball.friction = 0.3;
  ball.motion.centre = {3.5, 2, 4.6};
  ball.motion.stations = {{0.1, {}, 0}, {0.8, {0.3, 0.1, -0.5}, 0.2}};
  ball.coupling = Coupling{mass, 5e4, 20 * mass, mass, 5e4, 20 * mass};
  scene.contact.obstacles.push_back(ball);
  return scene;
}

TEST(BladeContact, ACompliantToolAndAHandFeelWhatTheBodyFeels) {
  for (const double mass : {0.5, 10., 1000.}) {
    SlabRun run(probed_slab(mass));
    const ContactLaw& contact = *run.simulation.contact();
    Vec3 velocity{}, spin{};
    double largest = 0;
    while (run.simulation.time() < 0.8) {
      const Pose before = contact.tool_state(1)->pose;
      const double dt = run.simulation.next_dt();
      run.simulation.advance({{}, 1}, run.nobody);
      const auto [pose, hand_force, hand_torque] = *contact.tool_state(1);
      const auto& [force, torque] = contact.loads()[1];
      const Vec3 moved = scaled(1 / dt, minus(pose.translation, before.translation)),
                 turned = scaled(1 / dt, rotation_between(before.turn, pose.turn));
      const double allowed = 1e-6 * (1 + norm(force) + norm(hand_force));
      const auto misfit = [&](const Vec3& change, const Vec3& load, const Vec3& hand) {
        return norm(minus(scaled(mass / dt, change), minus(load, hand)));
      };
      ASSERT_LT(misfit(minus(moved, velocity), force, hand_force), allowed);
      ASSERT_LT(misfit(minus(turned, spin), torque, hand_torque), allowed);
      velocity = moved;
      spin = turned;
      const Vec3 centre = plus(pose.centre, pose.translation);
      ASSERT_GT(run.least([&](const Vec3& place) { return norm(minus(place, centre)) - 1.5; }),
                -1e-6)
          << run.simulation.time();
      largest = std::max(largest, norm(force));
    }
    EXPECT_EQ(run.islands(), 2u);
    EXPECT_GT(largest, 500);
  }
}

// The points of a surface that is not cut yet are its vertices.
TEST(BladeContact, ACompliantToolPushesAnUncutSurfaceAsOneOfWholeElements) {
  Scene divisible = probed_slab(10), whole = divisible;
  divisible.events[0].at = 0.8;
  whole.events.clear();
  SlabRun one(divisible), other(whole);
  for (SlabRun* run : {&one, &other}) run->simulation.run_to(0.6, run->nobody);
  const auto a = *one.simulation.contact()->tool_state(1),
             b = *other.simulation.contact()->tool_state(1);
  EXPECT_GT(norm(other.simulation.contact()->loads()[1].force), 10);
  EXPECT_LT(norm(minus(a.hand_force, b.hand_force)), 1e-6 * norm(b.hand_force));
  EXPECT_LT(norm(minus(a.pose.translation, b.pose.translation)), 1e-8);
}

/// One or two planes, at random, through a body at rest without loads.
Scene cut_at_rest(std::mt19937& random) {
  std::uniform_real_distribution<double> any_part(0.1, 0.9);
  std::normal_distribution<double> any_direction;
  const Index length = random() % 2 + 1;
  Scene scene = block(tree_plugins(), "tm-faure", {1. * length, 1, 1}, {length, 1, 1},
                      {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}});
  scene.contact.pieces = true;
  const int cuts = random() % 2 == 0 ? 1 : 2;
  for (int i = 0; i < cuts; ++i) {
    Vec3 point, normal;
    for (double& c : point) c = any_part(random);
    for (double& c : normal) c = any_direction(random);
    point[0] *= length;
    scene.events.push_back(divide(point, normal));
    scene.events.back().at = 0.02 * i;
  }
  return scene;
}

TEST(BladeContact, NothingMovesWhereABodyAtRestIsCut) {
  double largest = 0;
  for (unsigned seed = 0; seed < 80; ++seed) {
    std::mt19937 random(seed);
    SlabRun run(cut_at_rest(random));
    run.simulation.run_to(0.5, run.nobody);
    EXPECT_GT(run.islands(), 1u) << seed;
    const EnergyBalance e = run.simulation.built().dynamics().balance();
    largest = std::max({largest, e.kinetic, e.elastic});
    EXPECT_LT(largest, 1e-15) << "J, seed " << seed;
  }
}

/// Two blocks of 1 m and 1000 kg, one on the other. With elements as large as the blocks, the upper
/// one is pressed into the lower one by a tenth of an edge in a step before contact acts.
TEST(BladeContact, ABlockStaysOnTheOneBelow) {
  for (const Index n : {1u, 2u})
    for (const double height : {1., 1.1}) {
      Scene scene = block(tree_plugins(), "tm-faure", {1, 1, 2}, {n, n, 2 * n},
                          {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}});
      scene.gravity = {0, 0, -9.8};
      hold(scene, at({any, any, 0}), 7);
      scene.contact.pieces = true;
      scene.contact.friction = 0.5;
      scene.solver.damping = 10;
      scene.events = {divide({0.5, 0.5, height}, {0, 0, 1})};
      SlabRun run(scene);
      run.simulation.run_to(2, run.nobody);
      EXPECT_LT(norm(run.momentum()), 0.01 * 9800) << n << " elements, cut at " << height;
      double top = 0;
      for (Index v = 0; v < run.attributes().vertex_count(); ++v)
        if (run.attributes().rest().get(v, 2) > 2 - 1e-9)
          top = std::max(top, run.attributes().position().get(v, 2));
      EXPECT_GT(top, 1.6) << n << " elements, cut at " << height;
    }
}

// A disc leaves a slit that ends inside, where both lips depend on the same vertices; a plane
// divides the bar beside it.
TEST(BladeContact, LipsMeetAtTheEndOfASlit) {
  Scene scene = block(tree_plugins(), "tm-faure", {1, 0.25, 0.25}, {10, 3, 3},
                      {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}});
  scene.gravity = {0, -2, 0};
  for (const double x : {0., 1.}) hold(scene, at({x, any, any}), 7);
  scene.contact.pieces = true;
  scene.solver.damping = 1.3;
  const CutPlane slit{
      .point = {0.5371, 0, 0}, .normal = {1, -0.05, 0}, .radius = 0.198, .along_blade = true},
      across{.point = {0.6166, 0, 0}, .normal = {1, 0.0832, 0}, .along_blade = true};
  for (const CutPlane& plane : {slit, across}) {
    Event& cut = scene.events.emplace_back();
    cut.what = plane;
    cut.path = "/events";
    cut.at = 0.09;
  }
  SlabRun run(scene);
  run.simulation.run_to(0.4, run.nobody);
  EXPECT_EQ(run.islands(), 2u);
  const EnergyBalance e = run.simulation.built().dynamics().balance();
  EXPECT_LT(std::abs(e.balance), 0.01 * e.exchanged);
}

// Two halves that a pressure presses together, free in space.
void expect_equal_pushes(const std::string& integrator) {
  Scene scene = slab();
  scene.solver.integrator = integrator;
  if (integrator == "implicit-euler") scene.solver.dt = 0.02;
  scene.gravity = {};
  scene.contact.obstacles.clear();
  scene.contact.pieces = true;
  scene.contact.friction = 0.3;
  scene.solver.damping = 0;
  for (const double x : {0., 8.}) {
    Load& load = scene.loads.emplace_back();
    load.kind = Load::Kind::traction;
    load.value = {x == 0 ? 2000. : -2000., 0, 0};
    load.where = at({x, any, any});
  }
  SlabRun run(scene);
  const auto angular = [&] {
    Vec3 sum{};
    for (Index v = 0; v < run.attributes().vertex_count(); ++v)
      sum = plus(sum, scaled(run.mass(v), cross(row(run.attributes().position().rows(), v),
                                                row(run.attributes().velocity().rows(), v))));
    return sum;
  };
  run.simulation.run_to(1.2, run.nobody);
  EXPECT_EQ(run.islands(), 2u);
  const double impulse = 2000 * 12 * 1.2;
  EXPECT_LT(norm(run.momentum()), (integrator == "implicit-euler" ? 1e-5 : 1e-10) * impulse);
  EXPECT_LT(norm(angular()), 0.01 * impulse);
  EXPECT_LT(run.simulation.contact()->friction_work(), 0);
}

TEST(BladeContact, LipsPushEachOtherEqually) {
  expect_equal_pushes("symplectic-euler");
  expect_equal_pushes("implicit-euler");
}

}  // namespace
}  // namespace suture::test::blade_contact_test
