// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sutures of what blades have divided: the body is as it was.
#include "kernel/operations/reunite.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "kernel/base/rows.hpp"
#include "kernel/run/simulation.hpp"
#include "tests/parts/blade_event.hpp"
#include "tests/parts/cut_box.hpp"
#include "tests/parts/plane_parts.hpp"
#include "tests/run/equilibrium.hpp"

namespace suture::test::reunite_test {
namespace {

PlanePatch plane_through(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> inside(0.5, 3.5);
  return {.point = {inside(random), inside(random), inside(random)},
          .normal = {normal(random), normal(random), normal(random)}};
}

TEST(Reunite, MakesABoxWholeAgain) {
  const unsigned runs = std::getenv("SUTURE_FULL") ? 1000 : 40;
  for (unsigned seed = 1; seed <= runs && !HasFatalFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    CutBox box({4, 4, 4});
    for (unsigned i = 0; i < 1 + seed % 4; ++i) box.cut(plane_through(random));
    box.sew_parts(std::vector<std::uint8_t>(box.complex.element_count(), 1));
    box.sew(seams_of_cuts(box.complex, box.point, {}).seams);
    ASSERT_NO_FATAL_FAILURE(expect_valid(box));
    EXPECT_EQ(box.islands.existing(), 1u);
    EXPECT_EQ(box.complex.existing(3), 64u);
    EXPECT_EQ(box.complex.existing(0), 125u);
    ASSERT_NEAR(box.volume(), 64, 64e-12);
    const Embedding& embedding = box.parts.embedding(box.complex);
    ASSERT_NO_FATAL_FAILURE(expect_closed(embedding));
    EXPECT_NEAR(surface_volume(box, embedding), 64, 64e-12);
    EXPECT_EQ(lip_area(box, embedding), 0);
  }
}

// Only on one side of a place: the slit ends there, as where a blade has ended.
TEST(Reunite, LeavesASlitElsewhere) {
  const unsigned runs = std::getenv("SUTURE_FULL") ? 500 : 40;
  for (unsigned seed = 1; seed <= runs && !HasFatalFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    CutBox box({8, 4, 4});
    std::uniform_real_distribution<double> tilt(-0.2, 0.2);
    box.cut({.point = {4, 2, 2}, .normal = {tilt(random), tilt(random), 1}});
    const double lips = lip_area(box, box.parts.embedding(box.complex));
    std::vector<std::uint8_t> is_wanted;
    for (Index e = 0; e < box.complex.element_count(); ++e)
      is_wanted.push_back(box.origin[e] % 8 < 4 ? 1 : 0);
    box.sew_parts(is_wanted);
    ASSERT_NO_FATAL_FAILURE(expect_valid(box));
    ASSERT_NEAR(box.volume(), 128, 128e-12);
    const Embedding& embedding = box.parts.embedding(box.complex);
    ASSERT_NO_FATAL_FAILURE(expect_closed(embedding));
    EXPECT_NEAR(surface_volume(box, embedding), 128, 128e-12);
    const double left = lip_area(box, embedding) / lips;  // with faces between whole elements
    EXPECT_GT(left, 0.4);
    EXPECT_LT(left, 0.9);
  }
}

// What is not wanted stays apart.
TEST(Reunite, LeavesPartsThatAreNotWanted) {
  const unsigned runs = std::getenv("SUTURE_FULL") ? 1000 : 40;
  for (unsigned seed = 1; seed <= runs && !HasFatalFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    CutBox box({4, 4, 4});
    for (unsigned i = 0; i < 2 + seed % 3; ++i) box.cut(plane_through(random));
    std::vector<std::uint8_t> is_wanted;
    for (Index e = 0; e < box.complex.element_count(); ++e)
      is_wanted.push_back(random() % 4 != 0 ? 1 : 0);
    box.sew_parts(is_wanted);
    ASSERT_NO_FATAL_FAILURE(expect_valid(box));
    ASSERT_NEAR(box.volume(), 64, 64e-12);
    const Embedding& embedding = box.parts.embedding(box.complex);
    ASSERT_NO_FATAL_FAILURE(expect_closed(embedding));
    EXPECT_NEAR(surface_volume(box, embedding), 64, 64e-12);
  }
}

// A whole element beside two parts, cut from the one and sewn to the other: on their faces, the
// surface is what they do not cover.
TEST(Reunite, SewnFacesShowWhatIsNotCovered) {
  CutBox box({2, 1, 1});
  PlanePatch disc{.point = {0.3, 0.5, 0.4}, .normal = {0, 0, 1}};
  disc.radius = 1;
  ASSERT_EQ(box.cut(disc).divided, 1u);
  const Dart whole = face_dart(1, cube_sides[0].face()), joined = box.complex.beta3(whole);
  const Index other = element_of(joined) == 2 ? 3 : 2;
  box.follow(box.complex.cut(std::vector<Dart>{whole}));
  box.sew({{corresponding_dart(other, joined), whole}});
  ASSERT_NO_FATAL_FAILURE(expect_valid(box));
  const Embedding& embedding = box.parts.embedding(box.complex);
  ASSERT_NO_FATAL_FAILURE(expect_closed(embedding));
  EXPECT_NEAR(surface_volume(box, embedding), 2, 2e-12);
  EXPECT_NEAR(lip_area(box, embedding), 2 * 1 + 2 * 0.6, 1e-12);
}

/// A bar, held at one end and pulled on its side, which an oblique plane cuts right through.
Scene pulled_bar() {
  Scene scene = block(tree_plugins(), "tm-faure", {8, 3, 3}, {8, 3, 3},
                      {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}});
  hold(scene, at({0, any, any}), 7);
  load(scene, at({any, 3, any}), {300, 0, 100});
  Event cut = divide({4.1, 1.4, 1.6}, {1, 0.3, 0.6});
  cut.at = 0;
  Event suture;
  suture.path = "/events/1";
  suture.what = SewFaces{};
  suture.at = 0;
  scene.events = {cut, suture};
  return scene;
}

struct SewnRun {
  explicit SewnRun(const Scene& scene) : simulation(scene, tree_plugins(), diagnostics) {}
  Vec3 end() {
    Attributes& a = simulation.built().body().attributes();
    Vec3 sum{};
    for (Index v = 0; v < a.vertex_count(); ++v)
      if (simulation.built().body().complex().exists(0, v) && row(a.rest().rows(), v)[0] > 7.99)
        sum = plus(sum, minus(row(a.position().rows(), v), row(a.rest().rows(), v)));
    return sum;
  }
  Vec3 momentum() {
    Attributes& a = simulation.built().body().attributes();
    Vec3 sum{};
    for (Index v = 0; v < a.vertex_count(); ++v)
      sum = plus(sum, scaled(a.mass().get(v, 0), row(a.velocity().rows(), v)));
    return sum;
  }
  Diagnostics diagnostics;
  Observer nobody;
  Simulation simulation;
};

TEST(Reunite, ASewnBarDeformsAsOneThatWasNeverCut) {
  Scene scene = pulled_bar();
  scene.solver.integrator = "static";
  SewnRun sewn(scene);
  sewn.simulation.run_to(1, sewn.nobody);
  scene.events.clear();
  SewnRun whole(scene);
  whole.simulation.run_to(1, whole.nobody);
  EXPECT_GT(norm(whole.end()), 0.1);
  EXPECT_LT(norm(minus(sewn.end(), whole.end())), 1e-6 * norm(whole.end()));
}

/// The stored energy of a simulation's body in a state that depends on rest places alone.
double energy_when_bent(Simulation& simulation) {
  Body& body = simulation.built().body();
  Attributes& a = body.attributes();
  for (Index v = 0; v < a.vertex_count(); ++v) {
    const Vec3 x = row(a.rest().rows(), v);
    a.position().set(v, 0, 1.1 * x[0] + 0.02 * x[0] * x[1]);
    a.position().set(v, 1, x[1] + 0.01 * x[0] * x[0]);
    a.position().set(v, 2, 0.95 * x[2] + 0.05 * x[1] * x[2]);
  }
  return body.models().energy(0);
}

// The functor of whole elements computes them again, whatever their shape, also after a resume and
// when other elements have been cut and sewn since.
TEST(Reunite, MakesElementsWholeForTheirLaw) {
  for (const bool is_warped : {false, true})
    for (const int element : {0, 1}) {
      SCOPED_TRACE(std::to_string(element) + (is_warped ? ", warped" : ""));
      Scene scene = block(tree_plugins(), "tm-faure", {8, 3, 3}, {8, 3, 3},
                          {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}, {"element", element}});
      if (is_warped) {
        scene.mesh.given =
            std::make_shared<const Mesh>(parts_test::warped(make_box(*scene.mesh.box), 0.2));
        scene.mesh.box.reset();
      }
      for (const double slope : {0.3, -0.2}) {
        scene.events.push_back(divide({4.1, 1.4, 1.6}, {1, slope, 0.6}));
        scene.events.back().at = 0;
        scene.events.emplace_back().what = SewFaces{};
        scene.events.back().path = "/events/1";
        scene.events.back().at = 0;
      }
      SewnRun sewn(scene);
      sewn.simulation.run_to(1e-5, sewn.nobody);
      Body& body = sewn.simulation.built().body();
      EXPECT_EQ(body.complex().existing(3), 72u);
      EXPECT_GT(body.complex().element_count(), 90u);
      EXPECT_TRUE(sewn.simulation.built().parts().empty());
      const StateTree state = sewn.simulation.save();
      const double energy = energy_when_bent(sewn.simulation);
      SewnRun resumed(scene);
      resumed.simulation.load(state);
      EXPECT_EQ(energy_when_bent(resumed.simulation), energy);
      scene.events.clear();
      scene.is_divisible = true;
      SewnRun whole(scene);
      whole.simulation.run_to(1e-5, whole.nobody);
      EXPECT_NEAR(energy_when_bent(whole.simulation) / energy, 1, 1e-13);
    }
}

// The halves fly apart, and are sewn when they are apart.
TEST(Reunite, KeepsMomentum) {
  Scene scene = pulled_bar();
  scene.constraints.clear();
  scene.solver.damping = 0;
  scene.solver.dt = 0.01;
  scene.events[1].at = 1;
  SewnRun run(scene);
  run.simulation.run_to(0.3, run.nobody);
  EXPECT_EQ(run.simulation.built().body().islands().existing(), 2u);
  const Vec3 before = run.momentum();
  Event suture = scene.events[1];
  const EventOutcome outcome = run.simulation.apply(suture, run.nobody);
  EXPECT_GT(outcome.elements_sewn, 9u);
  EXPECT_EQ(run.simulation.built().body().islands().existing(), 1u);
  // Velocities lag behind by half a step, in which vertices that are gone had forces.
  EXPECT_LT(norm(minus(run.momentum(), before)), 1e-3 * norm(before));
  run.simulation.run_to(0.6, run.nobody);
  const EnergyBalance e = run.simulation.built().dynamics().balance();
  EXPECT_LT(std::abs(e.balance), 0.01 * e.exchanged);
}

}  // namespace
}  // namespace suture::test::reunite_test
