// SPDX-License-Identifier: GPL-3.0-or-later
//
// Random thin and fast obstacles: a plate, a disc, a plate of triangles or a rod, 0.1 to 10 mm
// thick, is pressed into a block with elements of 50 mm, or the block falls onto it, with each
// solver. No node of the boundary may come to the other side. And some scenes with known forces.
//   SUTURE_FULL=1  200 scenes; otherwise 15
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <sstream>

#include "kernel/base/archive.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/build/built_scene.hpp"
#include "kernel/contact/contact.hpp"
#include "kernel/geometry/solid_surface.hpp"
#include "kernel/run/simulation.hpp"
#include "tests/geometry/surfaces.hpp"

namespace suture::test::thin_test {
namespace {

constexpr double h = 0.05, half = 2 * h;  // edge of the elements, half of that of the block; m
constexpr int checks = 25;                // of a run

enum class Law { euler, verlet, implicit, equilibria, springs };
enum class Kind { plate, disc, triangles, rod };
constexpr const char* law_names[] = {"symplectic-euler", "velocity-verlet", "implicit-euler",
                                     "static", "penalty"};

struct ThinScene {
  Scene scene;
  std::string text;
  Kind kind;
  double thickness, allowed;  ///< m; how deep a node may be
};

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double between(double a, double b) { return std::uniform_real_distribution<>(a, b)(engine_); }
  int below(int n) { return static_cast<int>(engine_() % static_cast<unsigned>(n)); }

 private:
  std::mt19937 engine_;
};

PluginHost& plugins() {
  static PluginHost host;
  return host;
}

Scene block(double young) {
  Scene scene;
  scene.title = "thin and fast";
  scene.mesh.box = BoxOptions{{-half, -half, -half}, {2 * half, 2 * half, 2 * half}, {4, 4, 4}};
  ModelUse use;
  use.name = "neo-hookean";
  use.model = &plugins().model(use.name);
  for (std::uint32_t p = 0; p < use.model->parameter_count; ++p) {
    const suture_parameter& parameter = use.model->parameters[p];
    const std::string name = parameter.name;
    use.parameters.push_back(name == "E"     ? young
                             : name == "nu"  ? 0.3
                             : name == "rho" ? 1000
                                             : parameter.default_value);
  }
  scene.models.push_back(use);
  scene.solver.threads = 1;
  scene.output.enabled = false;
  return scene;
}

/// Its upper side, or the axis of a rod, is in the plane z = 0.
Shape shape_of(Kind kind, double thickness) {
  constexpr double reach = 0.6;
  switch (kind) {
    case Kind::plate:
      return Box{{-reach, -reach, -thickness}, {reach, reach, 0}};
    case Kind::disc:
      return Cylinder{{0, 0, 0}, {0, 0, -thickness}, reach};
    case Kind::triangles:
      return Triangulated{std::make_shared<SolidSurface>(box_surface(
                              {-reach, -reach, -thickness / 2}, {reach, reach, thickness / 2})),
                          {0, 0, -thickness / 2}};
    case Kind::rod:
      break;
  }
  return Capsule{{0, -reach, 0}, {0, reach, 0}, thickness / 2};
}

constexpr double most_turn = 0.1;  // rad

/// The block hangs from its upper side; the obstacle rises from below, and turns a little.
void press(ThinScene& made, Random& random, Law law, Obstacle& obstacle) {
  Constraint& fixed = made.scene.constraints.emplace_back();
  fixed.where.what = Selection::Named{"z1"};
  const bool is_rod = made.kind == Kind::rod;
  const double way = random.between(0.5, 1.2) * h + 0.02;
  const bool is_explicit = law != Law::implicit && law != Law::equilibria;
  const double speed = law == Law::equilibria ? way : random.between(0.1, is_explicit ? 4. : 0.5);
  const double start = -half - (is_rod ? made.thickness / 2 : 0) - 0.03, end = way / speed;
  obstacle.motion.stations = {
      {0, {0, 0, start}, 0},
      {end, {0, 0, start + way}, is_rod ? 0 : most_turn * random.between(-1, 1)},
  };
  obstacle.motion.axis = {random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
  made.scene.solver.end = 1.2 * end;
  const double moves = way + most_turn;  // of the farthest point, at most
  if (law == Law::equilibria) made.scene.solver.dt = random.between(0.05, 0.9) * h / moves * end;
  if (law == Law::implicit) made.scene.solver.dt = random.between(0.05, 0.9) * h / moves * end;
  std::ostringstream text;
  text << ", pressed at " << speed << " m/s";
  made.text += text.str();
}

/// Several layers per step, at up to half of the wave speed.
void fall(ThinScene& made, Random& random, Law law, Obstacle& obstacle) {
  // Springs are soft: a block that is faster sinks in by more than its height.
  const double speed = random.between(3, law == Law::springs ? 8 : 18), way = 0.5;
  obstacle.motion.stations = {{0, {0, 0, -half - way}, 0}};
  obstacle.motion.axis = {random.between(-1, 1), random.between(-1, 1), 0};
  obstacle.motion.stations[0].angle = random.between(-0.2, 0.2);
  made.scene.gravity = {0, 0, -speed * speed / (2 * way)};
  made.scene.solver.end = 2 * way / speed + 0.03;
  if (law == Law::implicit) made.scene.solver.dt = random.between(0.02, 0.3) * h / speed;
  std::ostringstream text;
  text << ", falls at " << speed << " m/s";
  made.text += text.str();
}

ThinScene make(unsigned seed) {
  Random random(seed);
  const auto law = static_cast<Law>(random.below(5));
  ThinScene made{block(1e6), "", static_cast<Kind>(random.below(4)), 0, 0};
  if (made.kind == Kind::rod && law == Law::springs) made.kind = Kind::plate;  // no friction
  const bool falls = made.kind != Kind::rod && law != Law::equilibria && random.below(2) == 0;
  made.thickness = std::pow(10, random.between(made.kind == Kind::rod ? -3 : -4, -2));
  made.allowed = law == Law::springs                              ? 2 * h
                 : law == Law::implicit || law == Law::equilibria ? 1.01e-4 * h
                                                                  : 1e-9;
  Obstacle obstacle{"thin", "/contact/obstacles/0", shape_of(made.kind, made.thickness)};
  const bool slides = law == Law::springs || law == Law::equilibria;
  obstacle.friction = made.kind == Kind::rod ? 1 : slides ? 0 : random.between(0, 0.5);
  if (made.kind == Kind::rod) obstacle.motion.centre = {};
  made.scene.contact.penalty = law == Law::springs;
  if (law != Law::springs) made.scene.solver.integrator = law_names[static_cast<int>(law)];
  std::ostringstream text;
  text << "seed " << seed << ": " << law_names[static_cast<int>(law)] << ", "
       << name_of(obstacle.shape) << " of " << made.thickness * 1e3 << " mm";
  made.text = text.str();
  falls ? fall(made, random, law, obstacle) : press(made, random, law, obstacle);
  made.scene.contact.obstacles.push_back(obstacle);
  return made;
}

/// The node that is deepest below the upper side of the obstacle, or of the nodes that meet a rod,
/// below its axis. Without any code of contact.
double deepest(Simulation& simulation, const ThinScene& made) {
  const Obstacle& obstacle = simulation.contact()->obstacles()[0];
  const Pose pose = obstacle.motion.pose(simulation.time());
  Attributes& a = simulation.attributes();
  double deepest = -1;
  for (const Index v : dynamic_cast<const Contact&>(*simulation.contact()).surface().vertices()) {
    const auto at = [&](const Column& column) {
      return Vec3{column.get(v, 0), column.get(v, 1), column.get(v, 2)};
    };
    const Vec3 rest = plus(at(a.rest()), simulation.origin());
    if (made.kind == Kind::rod && (std::abs(rest[0]) > 1e-9 || rest[2] > 1e-9 - half)) continue;
    const Vec3 given = plus(pose.given(at(a.position())), simulation.origin());
    deepest = std::max(deepest, -given[2]);
  }
  return deepest;
}

std::string run(const ThinScene& made) {
  Diagnostics diagnostics;
  Simulation simulation(made.scene, plugins(), diagnostics);
  Observer nobody;
  double force = 0;
  for (int check = 1; check <= checks; ++check) {
    try {
      simulation.run_to(*made.scene.solver.end * check / checks, nobody);
    } catch (const Error& error) {
      return error.what();
    }
    force = std::max(force, norm(simulation.contact()->loads()[0].force));
    const double depth = deepest(simulation, made);
    if (depth > made.allowed)
      return "t = " + std::to_string(simulation.time()) + " s: a node is " + std::to_string(depth) +
             " m below the upper side";
  }
  return force > 1 ? "" : "nothing touched";
}

/// A plate presses a block of 4 x 4 x 4 elements of 50 mm by a quarter of its height.
Scene pressed_block(Law law, double thickness) {
  Scene scene = block(1e5);
  Constraint& fixed = scene.constraints.emplace_back();
  fixed.where.what = Selection::Named{"z1"};
  Obstacle plate{"plate", "/contact/obstacles/0", shape_of(Kind::plate, thickness)};
  plate.motion.stations = {{0, {0, 0, -half - 0.01}, 0}, {0.5, {0, 0, -half + 0.05}, 0}};
  scene.contact.obstacles.push_back(plate);
  scene.contact.penalty = law == Law::springs;
  if (law != Law::springs) scene.solver.integrator = law_names[static_cast<int>(law)];
  if (law == Law::implicit || law == Law::equilibria) scene.solver.dt = 0.02;
  scene.solver.damping = law == Law::equilibria ? 0 : 10;
  scene.solver.end = law == Law::equilibria ? 0.5 : 1;
  return scene;
}

double least_gap(Simulation& simulation) {
  double least = std::numeric_limits<double>::infinity();
  for (const double gap : simulation.contact()->gaps(simulation.time()))
    if (!std::isnan(gap)) least = std::min(least, gap);
  return least;
}

TEST(ThinAndFast, APlatePushesWithTheSameForceHoweverThin) {
  for (const Law law : {Law::euler, Law::verlet, Law::implicit, Law::equilibria, Law::springs}) {
    double thick = 0, of_thick = 0;
    for (const double thickness : {0.04, 0.01, 2e-3, 1e-3, 1e-4, 1e-6}) {
      Diagnostics diagnostics;
      Simulation simulation(pressed_block(law, thickness), plugins(), diagnostics);
      Observer nobody;
      simulation.run(nobody);
      const double force = -simulation.contact()->loads()[0].force[2];
      if (thick == 0) thick = force;
      EXPECT_GT(force, 400) << law_names[static_cast<int>(law)];
      EXPECT_NEAR(force, thick, 0.01 * thick)
          << law_names[static_cast<int>(law)] << ", " << thickness << " m";
      const double deepest = least_gap(simulation);
      if (thickness == 0.04) of_thick = deepest;
      EXPECT_NEAR(deepest, of_thick, 2e-4 * h) << "springs let nodes sink in by more than a foil";
    }
  }
}

/// The side that a node touches belongs to the state: by its place alone, a node on springs belongs
/// to the other side.
TEST(ThinAndFast, AStateKeepsTheSides) {
  for (const Law law : {Law::euler, Law::implicit, Law::springs}) {
    Diagnostics diagnostics;
    const Scene scene = pressed_block(law, 1e-4);
    Simulation first(scene, plugins(), diagnostics), second(scene, plugins(), diagnostics);
    Observer nobody;
    first.run_to(0.3, nobody);
    StateTree state;
    save_state(state, first.built().dynamics());
    load_state(state, second.built().dynamics());
    const auto force_after_steps = [](Simulation& simulation) {
      Dynamics& dynamics = simulation.built().dynamics();
      const double time = dynamics.time();
      for (int i = 1; i <= 10; ++i) dynamics.step(2e-3, time + 2e-3 * i);
      return simulation.contact()->loads()[0].force[2];
    };
    const double force = force_after_steps(first);
    EXPECT_LT(force, -100);
    EXPECT_EQ(force_after_steps(second), force) << law_names[static_cast<int>(law)];
  }
}

TEST(ThinAndFast, ABodyThatFallsAt30MetresPerSecondStaysAboveATray) {
  for (const Law law : {Law::euler, Law::verlet, Law::implicit, Law::springs}) {
    ThinScene made{block(1e7), "", Kind::plate, 1e-3, law == Law::springs ? 2 * h : 1.01e-4 * h};
    Obstacle tray{"tray", "/contact/obstacles/0", shape_of(Kind::plate, made.thickness)};
    tray.motion.stations = {{0, {0, 0, -half - 0.5}, 0}};
    made.scene.gravity = {0, 0, -900};
    made.scene.contact.obstacles.push_back(tray);
    made.scene.contact.penalty = law == Law::springs;
    if (law != Law::springs) made.scene.solver.integrator = law_names[static_cast<int>(law)];
    if (law == Law::implicit) made.scene.solver.dt = 5e-4;
    made.scene.solver.end = 0.05;
    EXPECT_EQ(run(made), "") << law_names[static_cast<int>(law)];
  }
}

TEST(ThinAndFast, WhatIsNarrowerThanAFaceGivesAWarning) {
  for (const double radius : {0.2 * h, 0.6 * h}) {
    Scene scene = block(1e5);
    scene.contact.obstacles.push_back(
        {"rod", "/contact/obstacles/0", Capsule{{-0.3, 0, -0.2}, {0.3, 0, -0.2}, radius}});
    Diagnostics diagnostics;
    Simulation simulation(scene, plugins(), diagnostics);
    const bool is_narrow = 2 * radius < h;
    ASSERT_EQ(diagnostics.warnings().size(), is_narrow ? 1u : 0u);
    if (is_narrow) {
      EXPECT_NE(diagnostics.warnings()[0].find("elements of at most 0.02 m"), std::string::npos)
          << diagnostics.warnings()[0];
    }
  }
}

TEST(ThinAndFast, NothingPasses) {
  const unsigned scenes = std::getenv("SUTURE_FULL") ? 200 : 15;
  unsigned slid_off = 0;
  for (unsigned seed = 1; seed <= scenes; ++seed) {
    const ThinScene made = make(seed);
    const std::string outcome = run(made);
    // A face snaps off a thin round bar: there is no equilibrium nearby, and the run says so.
    const bool is_told = outcome.find("slides off what holds it") != std::string::npos;
    if (is_told && made.kind == Kind::rod && made.scene.solver.integrator == "static")
      ++slid_off;
    else
      EXPECT_EQ(outcome, "") << made.text;
  }
  EXPECT_LE(slid_off, scenes / 20);
}

}  // namespace
}  // namespace suture::test::thin_test
