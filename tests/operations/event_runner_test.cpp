// SPDX-License-Identifier: GPL-3.0-or-later
//
// Each operation on its own: its effect on a body, its warnings and its errors.
#include "kernel/operations/event_runner.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "kernel/base/error.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/beam.hpp"

namespace suture::test {
namespace {

Selection selection(decltype(Selection::what) what, const char* path = "/where") {
  Selection result;
  result.what = std::move(what);
  result.path = path;
  return result;
}

/// A beam of 8 x 2 x 2 elements of 0.125 m, element i + 8 j + 16 k, and its events.
class Events : public testing::Test {
 protected:
  Event& add(EventOperation what) {
    Event event;
    event.what = std::move(what);
    event.path = "/events/" + std::to_string(scene.events.size());
    return scene.events.emplace_back(std::move(event));
  }
  void build() {
    built = std::make_unique<BuiltScene>(scene, diagnostics);
    built->dynamics().start();
    runner = std::make_unique<EventRunner>(scene, *built, diagnostics);
  }
  EventOutcome apply(EventOperation what) {
    if (!runner) build();
    Event event;
    event.what = std::move(what);
    event.path = "/now";
    return runner->apply(event, 0.5);
  }
  const CellComplex& complex() { return built->body().complex(); }
  /// What went wrong, and nothing has happened.
  template <class Error>
  std::string refusal(EventOperation what) {
    if (!runner) build();
    const Index elements = complex().existing(3);
    const Index vertices = complex().existing(0);
    std::string text = "no error";
    try {
      apply(std::move(what));
    } catch (const Error& error) {
      text = error.what();
    }
    EXPECT_EQ(complex().existing(3), elements);
    EXPECT_EQ(complex().existing(0), vertices);
    return text;
  }
  const std::vector<std::string>& warnings() { return diagnostics.warnings(); }
  void expect_warning(const std::string& words) {
    ASSERT_EQ(warnings().size(), 1u);
    EXPECT_NE(warnings()[0].find(words), std::string::npos) << warnings()[0];
  }
  /// Stretches the beam along x.
  void pull(double factor) {
    Column& x = built->body().attributes().position();
    for (Index v = 0; v < x.size(); ++v) x.set(v, 0, factor * x.get(v, 0));
  }

  Scene scene = beam(tree_plugins(), "tm-faure", 8, 2, 0);
  Diagnostics diagnostics;
  std::unique_ptr<BuiltScene> built;
  std::unique_ptr<EventRunner> runner;
};

const CutPlane middle{{0.5, 0, 0}, {1, 0, 0}};

// ------------------------------------------------------------------------ cut --

TEST_F(Events, APlaneCutsItsSectionAndOnceOnly) {
  const EventOutcome outcome = apply(middle);
  EXPECT_EQ(outcome.faces_cut, 4u);
  EXPECT_TRUE(outcome.changed());
  EXPECT_EQ(outcome.text(), "cut 4 faces");
  EXPECT_EQ(built->body().islands().existing(), 2u);
  EXPECT_TRUE(warnings().empty());
  EXPECT_FALSE(apply(middle).changed());
  expect_warning("t = 0.5 s: /now cut no face: the blade misses the body, or the faces there");
}

TEST_F(Events, RoomForThemIsMadeAhead) {
  add(middle);
  build();
  runner->make_ready();
  const double* const before = built->body().attributes().position().rows();
  EXPECT_EQ(apply(middle).faces_cut, 4u);
  EXPECT_EQ(built->body().attributes().position().rows(), before);
}

TEST_F(Events, ADiscCutsWhereItIs) {
  EXPECT_EQ(apply(CutPlane{{0.5, 0, 0}, {1, 0, 0}, 0.1}).faces_cut, 1u);
}

TEST_F(Events, ACutStatesTheAreaOfItsBladeAndWarnsWhereItDiffers) {
  const EventOutcome outcome = apply(CutPlane{{0.5, 0, 0}, {1, 0, 0}, 0.1});
  EXPECT_NEAR(outcome.area.opened, 1 / 64.0, 1e-12);
  EXPECT_NEAR(outcome.area.blade, M_PI / 4 * 0.01, 0.05 * M_PI / 4 * 0.01);
  EXPECT_NE(outcome.text().find("cut 1 face (0.0156 of the 0.00"), std::string::npos)
      << outcome.text();
  expect_warning("/now opened 0.0156 of the 0.00");
  const EventOutcome whole = apply(CutPlane{{0.25, 0, 0}, {1, 0, 0}, 0.5});
  EXPECT_NEAR(whole.area.opened, 1 / 16.0, 1e-12);
  EXPECT_NEAR(whole.area.blade, 1 / 16.0, 1e-12);
  EXPECT_EQ(warnings().size(), 1u);
}

TEST_F(Events, APlaneThatMissesWarnsAndNoMore) {
  EXPECT_EQ(apply(CutPlane{{3, 0, 0}, {1, 0, 0}}).text(), "");
  expect_warning("/now cut no face: the blade misses the body");
  EXPECT_EQ(warnings()[0].find("already been cut"), std::string::npos);
}

TEST_F(Events, APlaneCutsTheShapeThatItIsGivenIn) {
  build();
  pull(2);
  Event event;
  event.what = CutPlane{{1.5, 0, 0}, {1, 0, 0}};
  event.path = "/now";
  event.rest_shape = true;
  EXPECT_EQ(runner->apply(event, 0).faces_cut, 0u);
  event.rest_shape = false;
  EXPECT_EQ(runner->apply(event, 0).faces_cut, 4u);
}

TEST_F(Events, ASurfaceCutsWhatItSeparates) {
  const TemporaryFolder folder;
  const auto file = folder / "blade.obj";
  std::ofstream(file) << "v 510 -1000 -1000\nv 510 2000 -1000\nv 510 -1000 2000\nf 1 2 3\n";
  EXPECT_EQ(apply(CutSurface{file, 1e-3, {}}).faces_cut, 4u);
  EXPECT_EQ(apply(CutSurface{file, 1e-3, {0.25, 0, 0}}).faces_cut, 4u);
  EXPECT_TRUE(warnings().empty());
  EXPECT_EQ(apply(CutSurface{file, 1, {}}).faces_cut, 0u);
  expect_warning("/now cut no face");
  const std::string text = refusal<InputError>(CutSurface{folder / "none.obj", 1, {}});
  EXPECT_EQ(text.find("/now/cut: "), 0u) << text;
}

TEST_F(Events, ABladeCutsWhatItSweepsBetweenTwoTimes) {
  CutBlade blade;  // an edge along y that goes up through the beam
  blade.stations = {{0, {{0.51, -1, -0.1}, {0.51, 1, -0.1}}},
                    {1, {{0.51, -1, 0.4}, {0.51, 1, 0.4}}}};
  add(blade);
  build();
  EXPECT_EQ(runner->fire(0, 0).faces_cut, 0u);
  EXPECT_EQ(runner->fire(0, 0.5).faces_cut, 2u) << "as high as z = 0.15";
  EXPECT_EQ(runner->fire(0, 1).faces_cut, 2u);
  runner->finish();
  EXPECT_TRUE(warnings().empty());
  EXPECT_EQ(
      refusal<InputError>(blade),
      "/now/cut: a moving blade cannot be applied at one instant; add it to the scene as an event");
}

TEST_F(Events, ABladeGoesOnFromWhereItWentBackTo) {
  CutBlade blade;
  blade.stations = {{0, {{0.51, -1, -0.1}, {0.51, 1, -0.1}}},
                    {1, {{0.51, -1, 0.4}, {0.51, 1, 0.4}}}};
  add(blade);
  build();
  runner->fire(0, 0);
  runner->fire(0, 0.1);  // z = -0.05: nothing yet
  StateBuffer kept;
  kept.save(*runner);
  runner->fire(0, 0.15);
  kept.load(*runner);
  runner->roll_back(0.1);
  EXPECT_EQ(runner->fire(0, 1).faces_cut, 4u);
}

TEST_F(Events, ListedFacesAreCutOrReported) {
  EXPECT_EQ(apply(CutFaces{{{0, 1}, {3, 4}}}).faces_cut, 2u);
  EXPECT_TRUE(warnings().empty());
  EXPECT_EQ(apply(CutFaces{{{0, 1}, {1, 2}}}).faces_cut, 1u);
  expect_warning(
      "/now/cut/faces: 1 of the faces has already been cut, the first between elements 0 and 1");
  apply(Pierce{selection(Selection::Ids{{7}}), {}, 0});
  EXPECT_FALSE(apply(CutFaces{{{6, 7}}}).changed());
  EXPECT_NE(warnings().back().find("1 of the faces was removed with an element"), std::string::npos)
      << warnings().back();
}

TEST_F(Events, FacesThatTheMeshDoesNotHaveAreRefused) {
  EXPECT_EQ(refusal<InputError>(CutFaces{{{0, 1}, {0, 99}}}).find("/now/cut/faces"), 0u);
  EXPECT_EQ(refusal<InputError>(CutFaces{{{0, 5}}}).find("/now/cut/faces"), 0u) << "no neighbours";
}

// --------------------------------------------------------------------- pierce --

TEST_F(Events, PierceRemovesWhatIsSelectedOrNearItsPath) {
  const EventOutcome listed = apply(Pierce{selection(Selection::Ids{{0, 9}}), {}, 0});
  EXPECT_EQ(listed.elements_removed, 2u);
  EXPECT_EQ(listed.text(), "removed 2 elements");
  Pierce path;
  path.path = {{0.9375, 0.0625, -1}, {0.9375, 0.0625, 1}};
  path.radius = 0.01;
  EXPECT_EQ(apply(path).elements_removed, 2u) << "7 and 23";
  EXPECT_EQ(complex().existing(3), 28u);
  EXPECT_FALSE(apply(path).changed());
  EXPECT_NE(warnings().back().find("/now removed no element: there are none left where it pierces"),
            std::string::npos);
}

TEST_F(Events, PierceReportsLoadsAndConstraints) {
  Load load;
  load.kind = Load::Kind::force;
  load.value = {0, 0, 1};
  load.where = selection(Selection::Nearest{{1, 0, 0}});
  scene.loads.push_back(load);
  apply(Pierce{selection(Selection::Ids{{7}}), {}, 0});
  ASSERT_EQ(warnings().size(), 1u);
  EXPECT_EQ(warnings()[0],
            "t = 0.5 s: /now pierce removes all nodes or faces on which /loads/0 acts; it has no "
            "effect from now on");
  apply(Pierce{selection(Selection::Ids{{0}}), {}, 0});
  EXPECT_NE(
      warnings().back().find("removes some of the nodes or faces on which /constraints/0 acts"),
      std::string::npos);
}

TEST_F(Events, NobodyRemovesAll) {
  const std::string text = refusal<InputError>(Pierce{selection(Selection::All{}), {}, 0});
  EXPECT_EQ(text.find("t = 0.5 s: /now: pierce would remove all 32 remaining elements"), 0u)
      << text;
  EXPECT_NE(refusal<InputError>(Pierce{selection(Selection::Ids{{32}}), {}, 0}), "no error");
  EXPECT_NE(refusal<InputError>(Pierce{selection(Selection::Named{"nowhere"}), {}, 0}), "no error");
}

TEST_F(Events, IslandsThatAreSmallOrFarAreRemoved) {
  EXPECT_FALSE(apply(RemoveIslands{4, {}}).changed());
  expect_warning("/now removed no island");
  apply(CutPlane{{0.875, 0, 0}, {1, 0, 0}});
  EXPECT_FALSE(apply(RemoveIslands{4, {}}).changed()) << "it has 4";
  EXPECT_EQ(apply(RemoveIslands{5, {}}).elements_removed, 4u);
  apply(middle);
  EXPECT_EQ(
      apply(RemoveIslands{.outside = Selection::InBox{{-1, -1, -1}, {0.4, 1, 1}}}).elements_removed,
      12u);
  EXPECT_EQ(complex().existing(3), 16u);
}

// --------------------------------------------------------------------- suture --

TEST_F(Events, ASutureSewsWhatWasCutOrListedOrNear) {
  apply(middle);
  const EventOutcome all = apply(SewFaces{});
  EXPECT_EQ(all.faces_sewn, 4u);
  EXPECT_EQ(all.text(), "sewed 4 faces");
  EXPECT_FALSE(apply(SewFaces{}).changed());
  expect_warning("/now sewed no face: no cut face is open there");
  apply(middle);
  SewFaces listed;
  listed.element_pairs = {{3, 4}, {11, 12}};
  EXPECT_EQ(apply(listed).faces_sewn, 2u);
  listed.element_pairs = {{3, 4}, {19, 20}};
  EXPECT_EQ(apply(listed).faces_sewn, 1u);
  EXPECT_NE(warnings().back().find(
                "1 of the pairs still share a face or were removed; the first is elements 3 and 4"),
            std::string::npos)
      << warnings().back();
  SewFaces near;
  near.between = {selection(Selection::InBox{{0, 0, 0}, {0.5, 1, 1}}),
                  selection(Selection::InBox{{0.5, 0, 0}, {1, 1, 1}})};
  near.gap = 0.01;
  EXPECT_EQ(apply(near).faces_sewn, 1u);
  EXPECT_EQ(built->body().islands().existing(), 1u);
}

TEST_F(Events, ASutureOfWhatIsNotThereIsRefused) {
  SewFaces listed;
  listed.element_pairs = {{3, 4}, {3, 99}};
  EXPECT_EQ(refusal<InputError>(listed), "/now/suture/faces/1: the mesh has no element 99");
  SewFaces where;
  where.where = selection(Selection::Named{"nowhere"});
  EXPECT_NE(refusal<InputError>(where), "no error");
}

// ----------------------------------------------------------------------- tear --

TEST_F(Events, ATearOpensWhatIsStretched) {
  Tear tear;
  tear.above = 0.2;
  tear.max_fraction = 1;
  tear.where = selection(Selection::InBox{{0, 0, 0}, {0.5, 1, 1}});
  EXPECT_FALSE(apply(tear).changed());
  expect_warning("/now tore no face: the criterion is below its threshold everywhere");
  pull(1.3);
  const EventOutcome outcome = apply(tear);
  EXPECT_EQ(outcome.faces_torn, 3u * 4);
  EXPECT_EQ(outcome.faces_cut, 0u);
  EXPECT_EQ(outcome.text(), "tore 12 faces");
}

TEST_F(Events, ATearThatRepeatsSeesWhatWasRemoved) {
  Tear tear;
  tear.above = 0.2;
  tear.max_fraction = 1;
  add(tear).every = 1;
  build();
  EXPECT_EQ(runner->fire(0, 0.1).faces_torn, 0u);
  apply(Pierce{selection(Selection::Ids{{1}}), {}, 0});
  pull(1.3);
  EXPECT_EQ(runner->fire(0, 0.2).faces_torn, 7u * 4 - 2);
}

TEST_F(Events, ATearOfTooMuchIsRefused) {
  build();
  pull(1.3);
  Tear tear;
  tear.above = 0.2;
  const std::string text = refusal<NumericalError>(tear);
  EXPECT_NE(text.find("/now/tear: would tear"), std::string::npos) << text;
  tear.by = Tear::By::field;
  tear.model = "tm-faure";
  tear.field = "nothing";
  EXPECT_NE(refusal<PluginError>(tear), "no error");
}

// ------------------------------------------------------------------ the scene's --

TEST_F(Events, MistakesInTheSceneAreReportedBeforeAnythingRuns) {
  add(CutFaces{{{0, 99}}});
  EXPECT_THROW(build(), InputError);
  scene.events.clear();
  add(Pierce{selection(Selection::Named{"nowhere"}), {}, 0});
  EXPECT_THROW(build(), InputError);
  scene.events.clear();
  SewFaces sew;
  sew.element_pairs = {{0, 99}};
  add(sew);
  EXPECT_THROW(build(), InputError);
}

TEST_F(Events, WhatRepeatsIsReportedAtTheEndOnce) {
  add(CutPlane{{3, 0, 0}, {1, 0, 0}}).every = 5;
  add(middle).every = 5;
  Condition condition;
  condition.where = selection(Selection::Named{"x1"});
  add(middle).when = condition;
  build();
  for (const double time : {0.1, 0.2, 0.3}) {
    EXPECT_FALSE(runner->fire(0, time).changed());
    EXPECT_EQ(runner->fire(1, time).changed(), time == 0.1);
  }
  EXPECT_TRUE(warnings().empty());
  runner->finish();
  ASSERT_EQ(warnings().size(), 2u);
  EXPECT_EQ(warnings()[0], "/events/0: cut had no effect in the whole run");
  EXPECT_EQ(warnings()[1],
            "/events/2: cut had no effect in the whole run: its condition was never met");
}

}  // namespace
}  // namespace suture::test
