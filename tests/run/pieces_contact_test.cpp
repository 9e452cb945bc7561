// SPDX-License-Identifier: GPL-3.0-or-later
//
// Contact between pieces, lips and parts of one piece in explicit steps.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "kernel/contact/piece_overlap.hpp"
#include "tests/base/sanitizer.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/contact_scenes.hpp"
#include "tests/run/events.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

TEST(ContactScenes, AStackOfTwoPiecesComesToRest) {
  Scene scene = block_on_floor(2, {0, 0, -9.81}, 0.5);
  scene.contact.pieces = true;
  scene.contact.friction = 0.5;
  scene.solver.until_rest = scene.solver.automatic_damping = true;
  scene.events = {event_of(CutPlane{{0, 0, 0.1}, {0, 0, 1}})};
  TestSimulation simulation(scene);
  const RunSummary summary = simulation.run();
  EXPECT_EQ(summary.outcome, RunSummary::Outcome::at_rest);
  EXPECT_EQ(summary.faces_cut, 16u);
}

TEST(ContactScenes, TheUpperHalfOfACutBlockRestsOnTheLower) {
  double lowest[2];
  for (const bool pieces : {false, true}) {
    Scene scene = block_on_floor(4, {0, 0, -9.81}, 0.5);
    scene.contact.pieces = pieces;
    scene.contact.friction = 0.5;
    scene.solver.damping = 2;
    scene.solver.end = 1;
    Event cut = event_of(CutPlane{{0, 0, 0.101}, {0, 0, 1}}, 0.1);
    cut.rest_shape = true;
    scene.events = {cut};
    TestSimulation simulation(scene);
    EXPECT_EQ(simulation.run().faces_cut, 64u);
    Attributes& a = simulation.attributes();
    double low = 1;
    for (Index v = 0; v < a.vertex_count(); ++v)
      if (simulation.complex().dart_of(0, v) / 24 / 64 >= 2)
        low = std::min(low, a.position().get(v, 2));
    lowest[pieces] = low;
  }
  EXPECT_LT(lowest[0], 0.01) << "it falls through to the floor";
  EXPECT_GT(lowest[1], 0.09);
}

/// A block on a floor that two cuts open, one through it and one that ends inside.
Scene cut_block() {
  Scene scene = block_on_floor(12, {3, 0, -9.81}, 0.3);  // enough for a second thread
  scene.contact.pieces = true;
  scene.contact.friction = 0.2;
  scene.solver.end = 0.03;
  const auto cut = [&](double at, const CutPlane& plane) {
    Event event;
    event.at = at;
    event.what = plane;
    event.path = "/events/" + std::to_string(scene.events.size());
    event.rest_shape = true;
    scene.events.push_back(event);
  };
  cut(0.005, {{0, 0, 0.101}, {0.1, 0, 1}});
  cut(0.01, {{0.201, 0, 0}, {1, 0.2, 0}});
  return scene;
}

/// Letters that fall into a trough, each run a little different, and are cut there.
Scene falling_letters(std::mt19937& random) {
  std::uniform_real_distribution<double> jitter(-1, 1);
  Scene scene = beam(host(), "tm-faure", 1, 1, 0, {{"E", 1e6}, {"rho", 200}});
  scene.mesh.box.reset();
  scene.mesh.voxels =
      VoxelOptions{.size = 0.05,
                   .layers = 2,
                   .rows = {"TTTTT.LL...", "TTTTT.LL...", "..T...LL..A", "..T...LLLLA",
                            "..T...LLLLA", "...........", "..CCCC..III", "..CC....III",
                            "..CC.....I.", "..CCCC..III", "..CCCC..III"}};
  scene.constraints.clear();
  scene.gravity = {jitter(random), -9.81, 0.1 * jitter(random)};
  scene.solver.damping = 2;
  scene.solver.end = 2;
  scene.contact.pieces = true;
  scene.contact.friction = 0.3 + 0.2 * jitter(random);
  const double slope = 0.4 + 0.2 * jitter(random), middle = 0.28 + 0.05 * jitter(random);
  const auto wall = [&](const char* name, const Vec3& point, const Vec3& direction) {
    const Vec3 normal = scaled(1 / norm(direction), direction);
    scene.contact.obstacles.push_back({name, "", HalfSpace{point, normal}, {}, 0.3});
  };
  wall("left", {middle, -0.3, 0}, {slope, 1, 0});
  wall("right", {middle, -0.3, 0}, {-slope, 1, 0});
  wall("back", {0, 0, -0.01}, {0, 0, 1});
  wall("front", {0, 0, 0.11}, {0, 0, -1});
  scene.events = {event_of(CutPlane{{0.28, 0.1, 0}, {jitter(random), 1, 0}}, 0.3)};
  return scene;
}

/// How deep pieces are in each other and in obstacles, in elements.
double deepest(Simulation& simulation, double edge) {
  const auto& contact = dynamic_cast<const Contact&>(*simulation.contact());
  double depth = 0;
  for (const PieceOverlap& overlap :
       find_piece_overlaps(contact, simulation.complex(), simulation.attributes()))
    depth = std::max(depth, overlap.depth);
  for (const double gap : contact.gaps(simulation.time()))
    if (gap < 0) depth = std::max(depth, -gap);
  return depth / edge;
}

TEST(ContactScenes, LettersComeToRestInAPileWithoutEnteringEachOther) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::mt19937 random(seed);
    TestSimulation simulation(falling_letters(random));
    for (int frame = 1; frame <= 40; ++frame) {
      simulation.run_to(0.05 * frame);
      EXPECT_LT(deepest(simulation, 0.05), 0.1) << "seed " << seed << ", frame " << frame;
    }
    double kinetic = 0;  // relative to a fall of one letter
    Attributes& a = simulation.attributes();
    for (Index v = 0; v < a.vertex_count(); ++v) {
      const Vec3 velocity = row(a.velocity().rows(), v);
      kinetic += a.mass().get(v, 0) * dot(velocity, velocity) / 2 / (200 * 0.02 * 9.81 * 0.25);
    }
    EXPECT_LT(kinetic, 0.01) << "seed " << seed;
    EXPECT_GT(simulation.contact()->touches().size(), 20u);
  }
}

TEST(ContactScenes, PiecesAndLipsHaveTheSameBitsForAnyNumberOfThreads) {
  std::vector<double> first;
  for (const unsigned threads : thread_counts()) {
    Scene scene = cut_block();
    scene.solver.threads = threads;
    TestSimulation simulation(scene);
    simulation.run();
    const Column& x = simulation.attributes().position();
    const std::vector<double> all(x.rows(), x.rows() + 4 * std::size_t{x.size()});
    EXPECT_GT(simulation.contact()->touches().size(), 100u);
    if (threads == 1) first = all;
    EXPECT_EQ(all, first) << threads << " threads";
  }
}

TEST(ContactScenes, ABodyTouchesItselfOnRequest) {
  EXPECT_LT(slot_of(bent_u(false)), -0.01) << "the arms cross";
  EXPECT_NEAR(slot_of(bent_u(true)), 0, 0.1 * 0.05);
}

/// Two cubes of 2 x 2 x 2 elements that touch each other, the second one `shift` above the first.
Scene two_cubes(const TemporaryFolder& folder, double shift) {
  Scene scene = block_on_floor(1, {}, 0);
  use_boxes(scene, folder,
            {{.size = {1, 1, 1}, .cells = {2, 2, 2}},
             {.origin = {0.3, 0.2, shift}, .size = {1, 1, 1}, .cells = {2, 2, 2}}});
  scene.contact.obstacles.clear();
  scene.contact.pieces = true;
  return scene;
}

TEST(ContactScenes, PiecesThatOverlapAtTheStartAreReported) {
  TemporaryFolder folder;
  const auto message = [&](double shift) {
    Diagnostics diagnostics;
    try {
      const Simulation simulation(two_cubes(folder, shift), host(), diagnostics);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return diagnostics.warnings().empty() ? "" : diagnostics.warnings().front();
  };
  EXPECT_EQ(message(1), "");
  const std::string slight = message(0.9);
  EXPECT_NE(slight.find("elem"), std::string::npos) << slight;
  EXPECT_NE(slight.find("pushes them apart slowly"), std::string::npos) << slight;
  const std::string deep = message(0.5);
  EXPECT_NE(deep.find("the piece of element 0 and that of element 8"), std::string::npos) << deep;
  EXPECT_NE(deep.find("too deep"), std::string::npos) << deep;
}

/// Two that met too fast are inside each other, where contact leaves them.
TEST(ContactScenes, PiecesThatOverlapAtTheEndAreReported) {
  TemporaryFolder folder;
  Scene scene = two_cubes(folder, 1.1);
  scene.solver.dt = 1e-4;
  scene.solver.end = 1e-2;
  const auto warnings = [&](double jump) {
    TestSimulation simulation(scene);
    simulation.run_to(5e-3);
    for (Index v = 27; v < 54; ++v)
      simulation.attributes().position().set(v, 2,
                                             simulation.attributes().position().get(v, 2) - jump);
    simulation.run();
    return simulation.diagnostics.warnings();
  };
  EXPECT_TRUE(warnings(0.05).empty());
  const std::vector<std::string> found = warnings(0.5);
  ASSERT_FALSE(found.empty());
  EXPECT_NE(found.back().find("/contact: the piece of element 0 and that of element 8 overlap at "
                              "the end: "),
            std::string::npos)
      << found.back();
}

/// Where constraints leave no freedom, contact cannot hold.
TEST(ContactScenes, AFixedStepInWhichContactFailsStopsTheRun) {
  TemporaryFolder folder;
  Scene scene = two_cubes(folder, 1.05);
  for (const double z : {1., 1.05}) {
    Constraint& held = scene.constraints.emplace_back();
    held.where.what = Selection::Plane{{0, 0, z}, {0, 0, 1}, 1e-6};
    held.where.path = "/constraints";
  }
  scene.constraints[1].translation = {0, 0, -0.2};
  scene.constraints[1].ramp = {0, 0.1, true};
  scene.constraints[1].moves = true;
  scene.solver.dt = 1e-3;
  scene.solver.end = 0.1;
  TestSimulation simulation(scene);
  const std::string text = error_of(simulation);
  EXPECT_NE(text.find("contact did not hold: the pieces of elements "), std::string::npos) << text;
  EXPECT_NE(text.find("\"auto\""), std::string::npos) << text;
  EXPECT_LT(simulation.time(), 0.06);
}

}  // namespace
}  // namespace suture::test
