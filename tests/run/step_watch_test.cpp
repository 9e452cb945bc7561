// SPDX-License-Identifier: GPL-3.0-or-later
//
// When a run searches for its stable step, and which step it uses in between.
#include "kernel/steps/step_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "kernel/build/built_scene.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"

namespace suture::test {
namespace {

class Watch : public testing::Test {
 protected:
  Watch() : scene(beam(host(), "tm-faure", 8, 2, 10)), built(scene, diagnostics) {
    built.dynamics().start();
    bound = built.limits().bounds(0).dt;
    stable = built.limits().stable_step(built.dynamics().time());
  }
  /// A face on two sides of the body: a vertex of it splits. Returns the bound around it.
  double cut() {
    Dart inner = 0;
    while (!built.body().complex().can_cut(inner)) ++inner;
    const TopologyChange change = built.body().cut({inner});
    EXPECT_FALSE(change.splits[0].empty());
    std::vector<Index> vertices(change.stars[0].cells.begin(), change.stars[0].cells.end());
    bound = built.limits().bounds(0).dt;
    return built.limits().bounds_at(vertices, 0).dt;
  }
  /// A step, and those after it until what it began is done.
  void work(StepWatch& watch, std::uint64_t step) {
    watch.after_step(step);
    for (int more = 1; more < 1000 && built.limits().is_under_way(); ++more)
      watch.after_step(step + more);
    ASSERT_FALSE(built.limits().is_under_way());
  }
  Scene scene;
  Diagnostics diagnostics;
  BuiltScene built;
  double bound = 0, stable = 0;
};

TEST_F(Watch, AnEventLowersAutoToTheBoundAroundItUntilEventsAreOver) {
  StepWatch watch(scene, built, diagnostics);
  watch.start();
  EXPECT_NEAR(watch.stable(), stable, 0.02 * stable);
  EXPECT_GT(watch.stable(), 1.1 * bound);
  const double first = cut();
  watch.after_event(10);
  EXPECT_NEAR(watch.stable(), std::min(stable, first), 1e-12 * stable);
  EXPECT_LT(watch.stable(), stable);
  const double lower = std::min(first, cut());
  watch.after_event(300);
  EXPECT_NEAR(watch.stable(), lower, 1e-12 * stable);
  work(watch, 512);
  EXPECT_NEAR(watch.stable(), bound, 1e-12 * bound)
      << "an event 212 steps ago: no search, but all vertices";
  work(watch, 1200);
  EXPECT_NEAR(watch.stable(), built.limits().stable_step(built.dynamics().time()), 0.02 * stable);
}

TEST_F(Watch, AnEventThatChangesNoVertexLeavesTheStepAlone) {
  StepWatch watch(scene, built, diagnostics);
  watch.start();
  const double before = watch.stable();
  built.limits().bounds_of_changes(0);
  watch.after_event(500);
  EXPECT_EQ(watch.stable(), before);
  work(watch, 512);
  EXPECT_NEAR(watch.stable(), stable, 0.02 * stable) << "searched: no event lowered the step";
}

TEST_F(Watch, AnEventDuringASearchLowersItsResult) {
  StepWatch watch(scene, built, diagnostics);
  watch.start();
  watch.after_step(512);
  ASSERT_TRUE(built.limits().is_under_way());
  const double around = cut();
  watch.after_event(513);
  ASSERT_NEAR(watch.stable(), around, 1e-12 * stable);
  work(watch, 513);
  EXPECT_NEAR(watch.stable(), around, 1e-12 * stable);
  EXPECT_LT(watch.stable(), 0.95 * built.limits().stable_step(0, true));
}

TEST_F(Watch, AnAlarmDuringASearchEndsItAndAnotherBegins) {
  StepWatch watch(scene, built, diagnostics);
  watch.start();
  watch.after_step(512);
  ASSERT_TRUE(built.limits().is_under_way());
  EXPECT_FALSE(watch.is_unstable(512, 0.5 * stable));
  EXPECT_FALSE(built.limits().is_under_way());
  watch.after_step(513);
  EXPECT_TRUE(built.limits().is_under_way());
}

TEST_F(Watch, EventsInEveryStepDoNotKeepASearchAwayForever) {
  StepWatch watch(scene, built, diagnostics);
  watch.start();
  const auto lower = [&](std::uint64_t step) {
    Dart inner = 0;
    while (!built.body().complex().can_cut(inner)) inner += 4;
    const double before = watch.stable();
    built.body().cut({inner});
    watch.after_event(step);
    return watch.stable() < before;
  };
  ASSERT_TRUE(lower(1));
  double searched = 0;
  for (std::uint64_t step = 512; step <= 4600; step += 800) {
    work(watch, step);
    if (step < 4100) {
      EXPECT_NEAR(watch.stable(), built.limits().bounds(0).dt, 1e-12 * stable) << step;
      Column& x =
          built.body().attributes().position();  // so that the next cut lowers the step again
      for (Index v = 0; v < x.size(); ++v) x.set(v, 0, 1.03 * x.get(v, 0));
      built.dynamics().start(built.dynamics().time());
      ASSERT_TRUE(lower(step + 511)) << step;
    } else {
      searched = watch.stable();
    }
  }
  EXPECT_NE(searched, built.limits().bounds(0).dt);
  EXPECT_NEAR(searched, built.limits().stable_step(built.dynamics().time()), 0.02 * searched);
}

TEST_F(Watch, AFixedStepBelowTheBoundIsNotSearched) {
  scene.solver.dt = 0.9 * bound;
  StepWatch watch(scene, built, diagnostics);
  watch.start();
  EXPECT_EQ(watch.stable(), bound);
  EXPECT_TRUE(diagnostics.warnings().empty());
}

TEST_F(Watch, AFixedStepBetweenTheBoundAndTheLimitIsSearchedAndAccepted) {
  scene.solver.dt = (bound + stable) / 2;
  StepWatch watch(scene, built, diagnostics);
  watch.start();
  EXPECT_NEAR(watch.stable(), stable, 0.02 * stable);
  EXPECT_TRUE(diagnostics.warnings().empty());
}

TEST_F(Watch, AFixedStepThatAnEventMakesTooLongIsWarnedOfOnce) {
  scene.solver.dt = 0.98 * stable;
  StepWatch watch(scene, built, diagnostics);
  watch.start();
  EXPECT_TRUE(diagnostics.warnings().empty());
  for (Index v = 0; v < built.body().attributes().vertex_count();
       ++v)  // a stretched body is stiffer
    built.body().attributes().position().set(v, 0,
                                             1.5 * built.body().attributes().position().get(v, 0));
  built.dynamics().start(built.dynamics().time());
  ASSERT_LT(built.limits().stable_step(built.dynamics().time()), *scene.solver.dt);
  cut();
  watch.after_event(100);
  watch.after_step(101);
  EXPECT_TRUE(diagnostics.warnings().empty()) << "searched 101 steps ago";
  for (const std::uint64_t step : {512, 1024, 2048}) {
    watch.after_event(step);
    work(watch, step);
  }
  ASSERT_EQ(diagnostics.warnings().size(), 1u);
  EXPECT_NE(diagnostics.warnings()[0].find("/solver/dt"), std::string::npos);
}

}  // namespace
}  // namespace suture::test
