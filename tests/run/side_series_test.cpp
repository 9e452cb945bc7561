// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the series of springs, faces and cuts show.
#include "kernel/results/side_series.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernel/base/error.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/events.hpp"
#include "tests/run/host.hpp"
#include "tests/run/open_scene.hpp"

namespace suture::test {
namespace {

/// A beam of 8 x 2 x 2 elements, 1 m x 0.25 m x 0.25 m, with one series.
struct Shown : test::OpenScene {
  using OpenScene::OpenScene;
  Frame frame(double time) {
    built.dynamics().start();
    EXPECT_EQ(side_series(scene.output, fields, built, events).size(), 1u);
    return side(time);
  }
};

Scene scene_with_cuts() {
  Scene scene = beam(host(), "tm-faure", 8, 2, 0);
  scene.output.cuts = true;
  return scene;
}

const FrameField& field(const Frame& frame, const std::string& name) {
  return *std::ranges::find(frame.cell_fields, name, &FrameField::name);
}

TEST(CutSeries, ShowsBothSidesOfWhatIsOpen) {
  Scene scene = scene_with_cuts();
  scene.events = {event_of(CutPlane{{0.5, 0, 0}, {1, 0, 0}}), event_of(SewFaces{})};
  Shown shown(scene);
  EXPECT_TRUE(shown.frame(0).cells.empty());
  shown.events.fire(0, 0.25);
  const Frame cut = shown.frame(0.5);
  ASSERT_EQ(cut.cells.size(), 8u) << "2 x 2 faces, both sides";
  EXPECT_EQ(cut.points.size(), 18u) << "3 x 3 points on each side";
  for (const Vec3& p : cut.points) EXPECT_NEAR(p[0], 0.5, 1e-12);
  EXPECT_EQ(field(cut, "event").ids, std::vector<std::int64_t>(8, 0));
  EXPECT_EQ(field(cut, "blade").ids, std::vector<std::int64_t>(8, 0));
  EXPECT_EQ(field(cut, "opened").values, std::vector<double>(8, 0.25));

  shown.built.body().pierce({shown.events.opened()[0].side / 24});
  EXPECT_EQ(shown.frame(0.5).cells.size(), 7u) << "a side went with its element";
  shown.events.fire(1, 0.75);
  EXPECT_EQ(shown.frame(0.75).cells.size(), 1u) << "sewn but for the side that is alone";
}

TEST(CutSeries, ShowsABladeWhileItIsThere) {
  Scene scene = scene_with_cuts();
  CutBlade blade;
  blade.stations = {{1, {{0, -1, 0}, {0, 0, 0}, {0, 1, 0}}},
                    {3, {{4, -1, 0}, {4, 0, 0}, {4, 1, 0}}}};
  scene.events = {event_of(blade)};
  Shown shown(scene);
  EXPECT_TRUE(shown.frame(0.9).cells.empty());
  EXPECT_TRUE(shown.frame(3.1).cells.empty());
  const Frame frame = shown.frame(1.5);
  EXPECT_EQ(frame.cells, (std::vector<SmallCell>{{0, 1, none, none}, {1, 2, none, none}}));
  EXPECT_EQ(frame.points, (std::vector<Vec3>{{1, -1, 0}, {1, 0, 0}, {1, 1, 0}}));
  EXPECT_EQ(field(frame, "blade").ids, (std::vector<std::int64_t>{1, 1}));
  EXPECT_TRUE(std::isnan(field(frame, "opened").values[0]));
}

ModelUse use_of(const char* model) {
  ModelUse use;
  use.name = model;
  use.model = &host().model(model);
  use.parameters = {0.1};
  return use;
}

Scene scene_with_skin() {
  Scene scene = beam(host(), "tm-faure", 8, 2, 0);
  scene.models.push_back(use_of("skin"));
  scene.output.faces = true;
  return scene;
}

// The surface of the beam, 2 x 0.25^2 + 4 x 0.25 m^2, from 8 + 4 x 16 faces; a cut through it adds
// two ends.
TEST(FaceSeries, HasTheFieldsOfFunctorsOnFaces) {
  Scene scene = scene_with_skin();
  scene.events = {event_of(CutPlane{{0.5, 0, 0}, {1, 0, 0}})};
  Shown shown(scene);
  const auto area = [&](const Frame& frame) {
    double sum = 0;
    for (const double a : field(frame, "area").values) sum += a;
    return sum;
  };
  const Frame whole = shown.frame(0);
  EXPECT_EQ(whole.cells.size(), 72u);
  EXPECT_EQ(whole.points.size(), 9u * 9u - 7u);
  EXPECT_NEAR(area(whole), 1.125, 1e-12);
  shown.events.fire(0, 0);
  const Frame cut = shown.frame(0);
  EXPECT_EQ(cut.cells.size(), 80u);
  EXPECT_NEAR(area(cut), 1.25, 1e-12);
}

TEST(FaceSeries, RefusesFieldsOfOneNameAndDifferentWidth) {
  Scene scene = scene_with_skin();
  scene.models.push_back(use_of("vector-skin"));
  try {
    const Shown shown(scene);
    ADD_FAILURE();
  } catch (const PluginError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("'area' of 1 and of 3 components"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace suture::test
