// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a program that contains a simulation does to it between steps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/build/built_scene.hpp"
#include "kernel/geometry/centroid.hpp"
#include "kernel/scene/scene_error.hpp"
#include "kernel/scene/scene_reader.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Stops the run before step `last`.
struct Watcher : Observer {
  std::uint64_t last = ~std::uint64_t{0}, asked = 0;
  bool stop_requested() override { return asked++ >= last; }
};

Scene sagging_bar() {
  Scene scene = beam(host(), "tm-faure", 6, 2, 9.8);
  scene.solver.dt = 1e-4;
  scene.solver.end = 0.02;
  return scene;
}

std::vector<double> positions(Simulation& simulation) {
  const Column& x = simulation.attributes().position();
  return {x.rows(), x.rows() + std::size_t{x.size()} * 4};
}

/// A run of a bar, with everything that it refers to.
struct Bar {
  Diagnostics diagnostics;
  Scene scene = sagging_bar();
  Simulation simulation{scene, host(), diagnostics};
  Watcher watcher;
};

/// A spring of k to the rest position on every vertex; fails once when asked to.
struct Foundation : ForceTerm, TangentTerm, EnergyTerm {
  struct Fault {};
  Foundation(Attributes& attributes, double stiffness) : a(attributes), k(stiffness) {}
  const char* name() const override { return "foundation"; }
  void add_forces(double, const LiveMask&, double* rows) override {
    if (fails) throw Fault{};
    for (Index v = 0; v < a.vertex_count(); ++v)
      for (int c = 0; c < 3; ++c)
        rows[v * 4 + static_cast<Index>(c)] -= k * (a.position().get(v, c) - a.rest().get(v, c));
  }
  void add_forces_at(const VertexSelection&, std::span<const Index> vertices, double,
                     std::vector<Vec3>& forces) override {
    for (std::size_t i = 0; i < vertices.size(); ++i)
      for (int c = 0; c < 3; ++c)
        forces[i][static_cast<std::size_t>(c)] -=
            k * (a.position().get(vertices[i], c) - a.rest().get(vertices[i], c));
  }
  void add_tangent(const double* d, double dx, double, const TangentTime&, double* out) override {
    for (std::size_t i = 0; i < 3 * std::size_t{a.vertex_count()}; ++i) out[i] -= k * dx * d[i];
  }
  double energy(double) override {
    double sum = 0;
    for (Index v = 0; v < a.vertex_count(); ++v)
      for (int c = 0; c < 3; ++c)
        sum += k / 2 * std::pow(a.position().get(v, c) - a.rest().get(v, c), 2);
    return sum;
  }
  Attributes& a;
  double k;
  bool fails = false;
};

TEST(Advance, PausesAfterStepsWithoutChangingABit) {
  Bar whole, parts;
  EXPECT_EQ(whole.simulation.run(whole.watcher).steps, 200u);
  EXPECT_EQ(parts.simulation.advance({{}, 0}, parts.watcher), std::nullopt);
  EXPECT_EQ(parts.simulation.step(), 0u);
  for (const std::uint64_t steps : {1, 1, 30, 67})
    EXPECT_EQ(parts.simulation.advance({{}, steps}, parts.watcher), std::nullopt);
  EXPECT_EQ(parts.simulation.step(), 99u);
  EXPECT_EQ(parts.simulation.next_dt(), 1e-4);
  EXPECT_EQ(parts.simulation.advance({0.015, {}}, parts.watcher), std::nullopt);
  EXPECT_NEAR(parts.simulation.time(), 0.015, 1e-12);
  EXPECT_EQ(parts.simulation.advance({{}, 1000}, parts.watcher), RunSummary::Outcome::finished);
  EXPECT_EQ(parts.simulation.step(), 200u);
  EXPECT_EQ(positions(parts.simulation), positions(whole.simulation));
}

TEST(Advance, AnObserverInterruptsItAndTheRunGoesOn) {
  Bar bar;
  bar.watcher.last = 10;
  EXPECT_EQ(bar.simulation.advance({{}, 50}, bar.watcher), RunSummary::Outcome::interrupted);
  EXPECT_EQ(bar.simulation.step(), 10u);
  bar.watcher.last = ~std::uint64_t{0};
  EXPECT_EQ(bar.simulation.run(bar.watcher).outcome, RunSummary::Outcome::finished);
}

TEST(ChangeMotion, IsBookedAndKeepsConstraints) {
  Bar bar;
  bar.simulation.advance({{}, 20}, bar.watcher);
  const double before = bar.simulation.energies().total();
  bar.simulation.change_motion([](Attributes& a) {
    for (Index v = 0; v < a.vertex_count(); ++v) a.velocity().set(v, 2, 1);
  });
  const double given = bar.simulation.energies().total() - before;
  EXPECT_GT(given, 1);
  const EnergyBalance balance = bar.simulation.built().dynamics().balance();
  EXPECT_NEAR(balance.events, given, 1e-9 * given);
  EXPECT_LT(std::abs(balance.balance), 1e-3 * given);
  Attributes& a = bar.simulation.attributes();
  for (Index v = 0; v < a.vertex_count(); ++v)
    EXPECT_EQ(a.velocity().get(v, 2), a.fixed().get(v, 0) == 7 ? 0 : 1);
}

TEST(ChangeMotion, RefusesWhatIsNotFiniteAndChangesNothing) {
  Bar bar, twin;
  bar.simulation.advance({{}, 20}, bar.watcher);
  try {
    bar.simulation.change_motion([](Attributes& a) {
      a.position().set(3, 0, 7);
      a.position().set(5, 1, std::numeric_limits<double>::quiet_NaN());
    });
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("the position of node"));
    EXPECT_THAT(error.what(), HasSubstr("is not finite; nothing was changed"));
  }
  bar.simulation.run(bar.watcher);
  twin.simulation.run(twin.watcher);
  EXPECT_EQ(positions(bar.simulation), positions(twin.simulation));
}

TEST(AddTerm, ActsIsBookedAndLimitsTheStep) {
  Scene scene = sagging_bar();
  scene.solver.dt.reset();
  scene.solver.safety = 0.2;  // the balance decreases with the square of the step
  TestSimulation simulation(scene);
  Watcher watcher;
  simulation.run_to(0.01, watcher);
  const double dt = simulation.next_dt();
  auto& spring = dynamic_cast<Foundation&>(
      simulation.add_term(std::make_unique<Foundation>(simulation.attributes(), 1e6)));
  EXPECT_GT(spring.energy(0), 0);
  EXPECT_LT(simulation.next_dt(), 0.8 * dt);
  simulation.run(watcher);
  const EnergyBalance balance = simulation.built().dynamics().balance();
  EXPECT_GT(balance.events, 0);  // the spring was not relaxed when it came
  EXPECT_LT(std::abs(balance.balance), 0.02 * balance.exchanged);
}

TEST(AddTerm, AnExceptionOfATermLeavesTheRunAsItWas) {
  Bar bar, twin;
  std::vector<Foundation*> springs;
  for (Bar* one : {&bar, &twin}) {
    springs.push_back(&dynamic_cast<Foundation&>(
        one->simulation.add_term(std::make_unique<Foundation>(one->simulation.attributes(), 1e3))));
    one->simulation.advance({{}, 40}, one->watcher);
  }
  springs[0]->fails = true;
  EXPECT_THROW(bar.simulation.advance({{}, 5}, bar.watcher), Foundation::Fault);
  EXPECT_EQ(bar.simulation.step(), 40u);
  springs[0]->fails = false;
  bar.simulation.advance({{}, 60}, bar.watcher);
  twin.simulation.advance({{}, 60}, twin.watcher);
  EXPECT_EQ(bar.simulation.time(), twin.simulation.time());
  EXPECT_EQ(positions(bar.simulation), positions(twin.simulation));
}

TEST(AddTerm, ATermThatFailsAtOnceIsNotAdded) {
  Bar bar;
  auto term = std::make_unique<Foundation>(bar.simulation.attributes(), 1e3);
  term->fails = true;
  EXPECT_THROW(bar.simulation.add_term(std::move(term)), Foundation::Fault);
  bar.simulation.run(bar.watcher);
}

TEST(GivenMesh, RunsLikeTheSameBoxOfAScene) {
  const std::string text = R"({"suture": 1, "models": [{"model": "tm-faure", "parameters":
      {"E": 1e5, "nu": 0.3, "rho": 1000}}], "gravity": [0, -9.8, 0],
      "constraints": [{"fix": "xyz", "where": {"set": "x0"}}], "output": false,
      "solver": {"dt": 1e-4, "end": 0.005})";
  const std::string box = R"(, "mesh": {"box": {"origin": [5, 0, 0], "size": [3, 1, 1],
      "cells": [6, 2, 2]}})";
  BoxOptions options;
  options.origin = {5, 0, 0};
  options.size = {3, 1, 1};
  options.cells = {6, 2, 2};
  auto mesh = std::make_shared<Mesh>(make_local_box(options));
  Diagnostics diagnostics;
  const auto read = [&](const std::string& scene, std::shared_ptr<const Mesh> given) {
    return read_scene_text(scene, "scene", {}, lookup_of(host()), diagnostics, std::move(given));
  };
  const auto end_of = [&](const Scene& scene) {
    Simulation simulation(scene, host(), diagnostics);
    Watcher watcher;
    simulation.run(watcher);
    return positions(simulation);
  };
  const Scene given = read(text + "}", mesh);
  EXPECT_EQ(end_of(given), end_of(read(text + box + "}", nullptr)));
  mesh->points[7][1] += 0.01;
  EXPECT_NE(read(text + "}", mesh).hash, given.hash);
  EXPECT_THROW(read(text + "}", nullptr), SceneError);
  try {
    read(text + box + "}", mesh);
    FAIL();
  } catch (const SceneError& error) {
    ASSERT_EQ(error.mistakes().size(), 1u);
    EXPECT_EQ(error.mistakes()[0].path, "/mesh/box");
  }
}

/// The existing element whose centroid is nearest to a point now.
Index nearest_now(Simulation& simulation, const Vec3& point) {
  const double* rows = simulation.attributes().position().rows();
  Index nearest = none;
  double least = std::numeric_limits<double>::infinity();
  for (Index e = 0; e < simulation.complex().element_count(); ++e) {
    if (!simulation.complex().exists(3, e)) continue;
    const double distance =
        norm(minus(centroid(simulation.complex().vertices_of(e), rows, 4), point));
    if (distance < least) least = distance, nearest = e;
  }
  return nearest;
}

class PlacesInARun : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Of, PlacesInARun,
                         testing::Values("symplectic-euler", "velocity-verlet", "implicit-euler",
                                         "xpbd"),
                         [](const auto& scheme) {
                           std::string name = scheme.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

// A soft bar falls by many elements. Between two removals there are steps, cuts and jumps.
TEST_P(PlacesInARun, AreThoseOfTheElementsNow) {
  Scene scene = beam(tree_plugins(), "mss-baudet", 40, 8, 50, {{"E", 2e4}});
  scene.solver.integrator = GetParam();
  scene.solver.dt = 1e-3;
  scene.solver.end = 1;
  Diagnostics diagnostics;
  Simulation simulation(scene, tree_plugins(), diagnostics);
  Watcher watcher;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0, 1);
  for (int round = 0; round < 12; ++round) {
    simulation.run_to(simulation.time() + 0.01, watcher);
    if (round == 5)
      simulation.change_motion([](Attributes& attributes) {
        Column& x = attributes.position();
        for (Index v = 0; v < x.size(); ++v) x.set(v, 1, x.get(v, 1) * (1 + x.get(v, 0)));
      });
    const Vec3 point{share(random), 0.25 * share(random) - 0.3 * round * round / 144,
                     0.25 * share(random)};
    const Index expected = nearest_now(simulation, point);
    Event pierce;
    pierce.what = Pierce{};
    std::get<Pierce>(pierce.what).where = Selection{Selection::Nearest{point}, "/pierce"};
    EXPECT_THAT(simulation.apply(pierce, watcher).removed, ElementsAre(expected));
    Event cut;
    cut.what = CutPlane{point, {1, 0.2, 0}, 0.05};
    simulation.apply(cut, watcher);
    const Index next = nearest_now(simulation, point);
    EXPECT_THAT(simulation.apply(pierce, watcher).removed, ElementsAre(next));
  }
}

TEST(ReadEvent, IsAppliedAtOnceAndReportsItsCells) {
  Bar bar;
  const Event cut =
      read_event(R"({"cut": {"faces": [[0, 1]]}})", "cut()", bar.scene, bar.diagnostics);
  const EventOutcome outcome = bar.simulation.apply(cut, bar.watcher);
  EXPECT_EQ(outcome.faces_cut, 1u);
  EXPECT_THAT(outcome.faces, ElementsAre(std::array<Index, 2>{0, 1}));
  const Event pierce =
      read_event(R"({"pierce": {"where": {"ids": [3]}}})", "pierce()", bar.scene, bar.diagnostics);
  EXPECT_THAT(bar.simulation.apply(pierce, bar.watcher).removed, ElementsAre(3));
  const Event sew = read_event(R"({"suture": {}})", "suture()", bar.scene, bar.diagnostics);
  EXPECT_EQ(bar.simulation.apply(sew, bar.watcher).faces.size(), 1u);
}

TEST(ReadEvent, ListsEveryMistake) {
  Bar bar;
  try {
    read_event("{\"cut\": {\"plane\": {\"point\": [0, 0]}},\n \"at\": 1}", "cut()", bar.scene,
               bar.diagnostics);
    FAIL();
  } catch (const SceneError& error) {
    ASSERT_EQ(error.mistakes().size(), 3u) << error.what();
    EXPECT_EQ(error.mistakes()[0].path, "/cut/plane");
    EXPECT_EQ(error.mistakes()[1].path, "/cut/plane/point");
    EXPECT_EQ(error.mistakes()[2].path, "/at");
    EXPECT_EQ(error.mistakes()[2].line, 2u);
  }
}

}  // namespace
}  // namespace suture::test
