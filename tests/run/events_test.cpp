// SPDX-License-Identifier: GPL-3.0-or-later
//
// Events in a running simulation: when they happen, what they do, and what they report.
#include "tests/run/events.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "kernel/base/archive.hpp"
#include "kernel/base/error.hpp"
#include "kernel/results/event_report.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test::events_test {
namespace {

// What an observer hears.
// A bar of 8 x 2 x 2 elements along x that is pulled at x1 by `pull` m in 0.1 s.
Scene pulled_bar(double pull) {
  Scene scene = beam(host(), "tm-faure", 8, 2, 0);
  scene.solver.dt = 2e-4;
  scene.solver.end = 0.2;
  scene.solver.damping = 50;
  Constraint hand;
  hand.where.what = Selection::Named{"x1"};
  hand.moves = true;
  hand.translation = {pull, 0, 0};
  hand.ramp = {0, 0.1, true};
  scene.constraints.push_back(hand);
  return scene;
}

struct Outcome {
  Listener heard;
  Diagnostics diagnostics;
  RunSummary summary;
  std::unique_ptr<Simulation> simulation;

  explicit Outcome(const Scene& scene) {
    simulation = std::make_unique<Simulation>(scene, host(), diagnostics);
    summary = simulation->run(heard);
  }
};

Event tear_of(double above, std::uint64_t every) {
  Tear tear;
  tear.above = above;
  Event event = event_of(tear);
  event.every = every;
  return event;
}

// The bar necks nowhere: strain is largest at the hands, which hold the cross-section.
TEST(TearEvent, ABarThatIsPulledTearsAcross) {
  Scene scene = pulled_bar(0.6);
  scene.events.push_back(tear_of(0.45, 4));
  auto& tear = std::get<Tear>(scene.events[0].what);
  tear.where = Selection{};  // all
  tear.max_fraction = 1;     // the recoil of the halves tears many at once
  const Outcome run(scene);
  EXPECT_GE(run.summary.faces_torn, 4u) << "a cross-section has four faces";
  EXPECT_EQ(run.summary.faces_cut, 0u);
  Index islands = 0;
  run.simulation->complex().islands(&islands);
  EXPECT_GE(islands, 2u);
  ASSERT_FALSE(run.heard.lines.empty());
  EXPECT_NE(run.heard.lines[0].find(" s: tore "), std::string::npos) << run.heard.lines[0];
  EXPECT_TRUE(run.diagnostics.warnings().empty());
}

TEST(TearEvent, WithoutEffectIsReportedOnce) {
  Scene scene = pulled_bar(0.01);
  scene.events.push_back(tear_of(0.3, 1));
  const Outcome run(scene);
  EXPECT_EQ(run.summary.faces_torn, 0u);
  EXPECT_TRUE(run.heard.lines.empty());
  ASSERT_EQ(run.diagnostics.warnings().size(), 1u);
  EXPECT_EQ(run.diagnostics.warnings()[0], "/events/0: tear had no effect in the whole run");
}

// Checking changes nothing: the same bits as a run without the event.
TEST(TearEvent, ALookChangesNoBit) {
  std::vector<double> places;
  for (const bool looks : {false, true}) {
    Scene scene = pulled_bar(0.1);
    if (looks) scene.events.push_back(tear_of(0.9, 1));
    Outcome run(scene);
    const Column& x = run.simulation->attributes().position();
    const std::vector<double> now(x.rows(), x.rows() + std::size_t{4} * x.size());
    if (!looks) places = now;
    EXPECT_EQ(now, places);
  }
}

TEST(TearEvent, EverythingAtOnceStopsTheRunAndTearsNothing) {
  Scene scene = pulled_bar(0.6);
  scene.events.push_back(tear_of(0.2, 1));
  scene.events[0].from = 0.09;
  scene.solver.on_failure = OnFailure::stop;
  TestSimulation simulation(scene);
  Listener heard;
  try {
    simulation.run(heard);
    ADD_FAILURE();
  } catch (const NumericalError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("/events/0/tear: would tear"), std::string::npos) << text;
  }
  Index islands = 0;
  simulation.complex().islands(&islands);
  EXPECT_EQ(islands, 1u);
  EXPECT_TRUE(heard.lines.empty());
}

// One line when it begins, one for each change of the number of islands, one in the end.
TEST(EventReport, GathersTheStepsOfAnEventThatRepeats) {
  const std::vector<Event> events{tear_of(0.3, 1), event_of(CutPlane{})};
  EventReport report(events);
  EventOutcome torn, cut;
  torn.faces_torn = 2;
  cut.faces_cut = 5;
  using Lines = std::vector<std::string>;
  EXPECT_EQ(report.add(0, torn, 0.25, 1), Lines{"t = 0.25 s: tore 2 faces, 1 island"});
  EXPECT_EQ(report.add(0, torn, 0.5, 1), Lines{});
  EXPECT_EQ(report.add(0, torn, 0.75, 1), Lines{});
  EXPECT_EQ(report.add(1, cut, 0.75, 1),
            (Lines{"t = 0.5 to 0.75 s: tore 4 faces in 2 steps, 1 island",
                   "t = 0.75 s: cut 5 faces, 1 island"}));
  EXPECT_EQ(report.add(0, torn, 1, 1), Lines{});
  EXPECT_EQ(report.add(0, torn, 1.25, 2),
            Lines{"t = 1 to 1.25 s: tore 4 faces in 2 steps, 2 islands"});
  EXPECT_EQ(report.add(0, torn, 1.5, 2), Lines{});
  EXPECT_EQ(report.finish(), Lines{"t = 1.5 s: tore 2 faces, 2 islands"});
  EXPECT_EQ(report.finish(), Lines{});
}

// A line that begins before a checkpoint and ends after it counts every effect once.
TEST(EventReport, GathersAcrossACheckpoint) {
  const std::vector<Event> events{tear_of(0.3, 1)};
  EventOutcome outcome;
  outcome.faces_cut = 1;
  outcome.faces_torn = 2;
  outcome.faces_sewn = 3;
  outcome.elements_removed = 4;
  outcome.elements_cut = 5;
  outcome.elements_sewn = 6;
  outcome.nodes_held = 7;
  outcome.nodes_released = 8;
  outcome.debris = {9, 10, 1e-6, 0.001, {1, 2, 3}, 11};
  EventReport whole(events), stopped(events), resumed(events);
  for (EventReport* report : {&whole, &stopped}) {
    report->add(0, outcome, 0.25, 1);
    report->add(0, outcome, 0.5, 1);
  }
  StateTree tree;
  save_state(tree, stopped);
  load_state(tree, resumed);
  for (EventReport* report : {&whole, &resumed}) report->add(0, outcome, 0.75, 1);
  EXPECT_EQ(resumed.finish(), whole.finish());
}

// By the model's own value on elements, and on edges.
TEST(TearEvent, ByAValueThatAModelDeclares) {
  for (const char* model : {"tm-faure", "mss-baudet"}) {
    Scene scene = pulled_bar(0.6);
    const bool springs = std::string(model) == "mss-baudet";
    scene.models = beam(host(), model, 8, 2, 0).models;
    Tear tear;
    tear.by = Tear::By::field;
    tear.model = model;
    tear.field = springs ? "strain" : "von_mises";
    tear.above = springs ? 0.45 : 250e3;
    Event event = event_of(tear);
    event.every = 2;
    scene.events.push_back(event);
    const Outcome run(scene);
    EXPECT_GE(run.summary.faces_torn, 4u) << model;
  }
}

// Cuts at multiples of 4 steps, each undone in the same step.
TEST(Schedule, EveryCountsStepsFromUntil) {
  Scene scene = pulled_bar(0.1);
  Event cut = event_of(CutPlane{{0.5, 0, 0}, {1, 0, 0}});
  cut.every = 4;
  cut.from = 0.01;     // step 50
  cut.until = 0.0204;  // step 102
  Event sew = event_of(SewFaces{});
  sew.every = 1;
  scene.events = {cut, sew};
  const Outcome run(scene);
  // Steps 52, 56, ... 100; step 102 is no multiple of 4. Checks without effect are not
  // reported where others had one.
  ASSERT_EQ(run.heard.lines.size(), 2u * 13);
  EXPECT_EQ(run.heard.lines.front(), "t = 0.0104 s: cut 4 faces, 2 islands") << "step 52";
  EXPECT_EQ(run.heard.lines.back(), "t = 0.02 s: sewed 4 faces, 1 island") << "step 100";
  EXPECT_TRUE(run.diagnostics.warnings().empty());
}

// x1 moves as 3 s^2 - 2 s^3 of 0.1 m: half of it at t = 0.05 s.
TEST(Schedule, WhenHoldsOnceItsConditionIsTrue) {
  for (const auto of : {Condition::Of::displacement, Condition::Of::position}) {
    Scene scene = pulled_bar(0.1);
    Event cut = event_of(CutPlane{{0.5, 0, 0}, {1, 0, 0}});
    Condition condition;
    condition.where.what = Selection::Named{"x1"};
    condition.of = of;
    condition.component = of == Condition::Of::displacement ? 3 : 0;
    condition.bound = (of == Condition::Of::displacement ? 0 : 1) + 0.05 - 1e-6;
    condition.every = 5;
    cut.when = condition;
    scene.events.push_back(cut);
    const Outcome run(scene);
    ASSERT_EQ(run.heard.lines.size(), 1u);
    EXPECT_EQ(run.heard.lines[0], "t = 0.05 s: cut 4 faces, 2 islands");
    EXPECT_TRUE(run.diagnostics.warnings().empty());
  }
}

TEST(Schedule, AConditionThatNeverHoldsIsReported) {
  Scene scene = pulled_bar(0.1);
  Event cut = event_of(CutPlane{{0.5, 0, 0}, {1, 0, 0}});
  cut.when = Condition{};
  cut.when->bound = 0.2;
  scene.events.push_back(cut);
  const Outcome run(scene);
  EXPECT_EQ(run.summary.faces_cut, 0u);
  ASSERT_EQ(run.diagnostics.warnings().size(), 1u);
  EXPECT_NE(run.diagnostics.warnings()[0].find("never met"), std::string::npos);
}

// The same operation between two calls of run_to().
TEST(Apply, MakesAnOperationFromOutside) {
  Scene scene = pulled_bar(0.1);
  TestSimulation simulation(scene);
  Listener heard;
  simulation.run_to(0.05, heard);
  CutPlane half{{0.5, 0, 0}, {1, 0, 0}};
  half.polygon = {{0.5, 0, -1}, {0.5, 0.125, -1}, {0.5, 0.125, 1}, {0.5, 0, 1}};
  simulation.apply(event_of(half), heard);
  EXPECT_EQ(heard.lines,
            (std::vector<std::string>{"t = 0.05 s: cut 2 faces (0.0303 of the 0.0303 m^2 of the "
                                      "blade in the body), 1 island"}));
  simulation.apply(event_of(CutPlane{{0.5, 0, 0}, {1, 0, 0}}), heard);
  EXPECT_EQ(heard.lines.back(), "t = 0.05 s: cut 2 faces, 2 islands");
  EXPECT_EQ(simulation.run(heard).faces_cut, 4u);
}

}  // namespace
}  // namespace suture::test::events_test
