// SPDX-License-Identifier: GPL-3.0-or-later
//
// The events of a scene: every operation, every kind of timing, every mistake.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/scene/fake_model.hpp"

namespace suture::testing {
namespace {

Scene events(const std::string& list) { return read(scene_with(", \"events\": [" + list + "]")); }

template <class What>
What only(const std::string& event) {
  const Scene scene = events(event);
  return std::get<What>(scene.events.at(0).what);
}

TEST(Events, OfOneTimeKeepTheirOrderAndRepeatedOnesStartFromWhereTheyStart) {
  const Scene scene = events(R"(
    {"at": 0.5, "cut": {"faces": [[0, 1]]}},
    {"every": 4, "from": 0.25, "until": 0.75, "tear": {"by": "elongation", "above": 0.5}},
    {"at": 0, "cut": {"faces": [[2, 3]]}},
    {"at": 0.5, "cut": {"faces": [[4, 5]]}},
    {"when": {"where": {"set": "x1"}, "of": "velocity", "component": "y", "below": -2,
              "every": 10}, "cut": {"faces": [[6, 7]]}})");
  std::vector<std::string> order;
  for (const Event& event : scene.events) order.push_back(event.path);
  EXPECT_EQ(order, (std::vector<std::string>{"/events/2", "/events/4", "/events/1", "/events/0",
                                             "/events/3"}));
  const Event& repeated = scene.events[2];
  EXPECT_EQ(repeated.every, 4u);
  EXPECT_EQ(repeated.from, 0.25);
  EXPECT_EQ(*repeated.until, 0.75);
  EXPECT_FALSE(repeated.is_timed());
  const Condition& condition = *scene.events[1].when;
  EXPECT_EQ(condition.of, Condition::Of::velocity);
  EXPECT_EQ(condition.component, 1);
  EXPECT_FALSE(condition.above);
  EXPECT_EQ(condition.bound, -2);
  EXPECT_EQ(condition.every, 10u);
}

TEST(Events, PlanesMayCutAlongTheBlade) {
  const auto cut = [](const std::string& along) {
    return only<CutPlane>(
        R"({"at": 0, "cut": {"plane": {"point": [1, 2, 3], "normal": [0, 0, 2]})" + along + "}}");
  };
  EXPECT_FALSE(cut("").along_blade);
  EXPECT_FALSE(cut(R"(, "along": "faces")").along_blade);
  EXPECT_TRUE(cut(R"(, "along": "blade")").along_blade);
}

TEST(Events, PlanesMayBeBounded) {
  const auto disc = only<CutPlane>(
      R"({"at": 0, "cut": {"plane": {"point": [1, 2, 3], "normal": [0, 0, 2], "radius": 0.5}}})");
  EXPECT_EQ(disc.radius, 0.5);
  const auto polygon = only<CutPlane>(
      R"({"at": 0, "cut": {"plane": {"polygon": [[0,0,1], [2,0,1], [2,3,1], [0,3,1]]}}})");
  EXPECT_EQ(polygon.normal, (Vec3{0, 0, 12})) << "twice the area, by the right hand";
  EXPECT_EQ(polygon.polygon.size(), 4u);
  const auto with_hole = only<CutPlane>(R"({"at": 0, "cut": {"plane": {"polygon": [[0,0,0],
      [3,0,0], [3,3,0], [0,3,0], [0,0,0], [1,1,0], [1,2,0], [2,2,0], [2,1,0], [1,1,0]]}}})");
  EXPECT_EQ(with_hole.normal, (Vec3{0, 0, 16})) << "sides that touch do not cross";
}

// A list of faces has no blade.
TEST(Events, CutsOfVersionTwoFollowTheBladeWhereTheyCan) {
  const auto follows = [](const std::string& version, const std::string& cut) {
    const Scene scene =
        read(scene_with(R"(, "events": [{)" + cut + R"(}], "contact": {"obstacles": [{
          "name": "knife", "sphere": {"centre": [9, 0, 0], "radius": 1}}]})"),
             {"/suture=" + version});
    return scene.events[0].is_along_blade();
  };
  const std::string plane = R"("plane": {"point": [1, 2, 3], "normal": [0, 0, 2]})";
  const std::string carried = R"("obstacle": "knife", "points": [[0, 0, 0], [1, 0, 0]])";
  const std::string at = R"("at": 0, )";
  EXPECT_TRUE(follows("2", at + R"("cut": {)" + plane + "}"));
  EXPECT_FALSE(follows("1", at + R"("cut": {)" + plane + "}"));
  EXPECT_FALSE(follows("2", at + R"("cut": {"along": "faces", )" + plane + "}"));
  EXPECT_TRUE(follows("2", R"("cut": {"blade": {)" + carried + "}}"));
  EXPECT_TRUE(
      follows("2", R"("cut": {"blade": {)" + carried + R"(, "resistance": {"toughness": 1}}})"));
  EXPECT_FALSE(follows("2", at + R"("cut": {"faces": [[0, 1]]})"));
}

TEST(Events, TearNamesWhatItLooksAt) {
  const auto tear = only<Tear>(
      R"({"every": 1, "tear": {"by": "principal-strain", "above": 0.3, "most": 0.5,
          "where": {"half_space": {"point": [0, 0, 0], "normal": [1, 0, 0]}}}})");
  EXPECT_EQ(tear.by, Tear::By::principal_strain);
  EXPECT_EQ(tear.above, 0.3);
  EXPECT_EQ(tear.max_fraction, 0.5);
  EXPECT_EQ(tear.where->path, "/events/0/tear/where");
}

TEST(Events, ABladeHasTimesOfItsOwn) {
  const Scene scene = events(R"(
    {"cut": {"blade": {"path": [{"at": 0.25, "points": [[0, 0, 0], [1, 0, 0]]},
                                {"at": 0.5, "points": [[0, 1, 0], [1, 2, 0]]}]}}},
    {"cut": {"blade": {"path": [{"at": 0, "points": [[0, 0, 0], [1, 0, 0]]}]}}})");
  EXPECT_EQ(scene.events[0].path, "/events/1");
  EXPECT_TRUE(std::isinf(scene.events[0].finish())) << "a blade that stands still";
  EXPECT_EQ(scene.events[1].start(), 0.25);
  EXPECT_EQ(scene.events[1].finish(), 0.5);
  EXPECT_FALSE(scene.events[1].is_timed());
  EXPECT_EQ(std::get<CutBlade>(scene.events[1].what).stations[1].points[1], (Vec3{1, 2, 0}));
}

TEST(Events, PierceSutureAndRemoval) {
  const auto pierce = only<Pierce>(
      R"({"at": 0, "pierce": {"path": [[0, 0, 0], [1, 1, 1]], "radius": 0.5}, "shape": "rest"})");
  EXPECT_EQ(pierce.path.size(), 2u);
  EXPECT_EQ(pierce.radius, 0.5);
  EXPECT_TRUE(std::holds_alternative<Selection::Ids>(
      only<Pierce>(R"({"at": 0, "pierce": {"where": {"ids": [3, 4]}}})").where->what));
  const auto between = only<SewFaces>(
      R"({"at": 0, "suture": {"between": [{"set": "a"}, {"set": "b"}], "gap": 0.1}})");
  EXPECT_EQ((*between.between)[1].path, "/events/0/suture/between/1");
  EXPECT_EQ(between.gap, 0.1);
  EXPECT_EQ(only<SewFaces>(R"({"at": 0, "suture": {"faces": [[1, 2]]}})").element_pairs.size(), 1u);
  EXPECT_FALSE(only<SewFaces>(R"({"at": 0, "suture": {}})").where);
  const auto remove = only<RemoveIslands>(
      R"({"every": 9, "remove_islands": {"below": 8,
          "outside": {"box": {"min": [0, 0, 0], "max": [1, 1, 1]}}}})");
  EXPECT_EQ(remove.below, 8u);
  EXPECT_EQ(remove.outside->max[2], 1);
}

struct BadEvent {
  const char* event;
  const char* path;
  const char* words;
};
void PrintTo(const BadEvent& bad, std::ostream* stream) { *stream << bad.event; }

class EventMistakes : public ::testing::TestWithParam<BadEvent> {};
TEST_P(EventMistakes, AreNamed) {
  const BadEvent& bad = GetParam();
  const std::string error = error_of(scene_with(std::string(", \"events\": [") + bad.event + "]"));
  EXPECT_NE(error.find(std::string(bad.path) + ": "), std::string::npos) << error;
  EXPECT_NE(error.find(bad.words), std::string::npos) << error;
}

TEST(Events, GraspsMoveInTimesOfTheirOwn) {
  const Scene scene = events(R"(
    {"at": 0.25, "grasp": {"name": "clamp", "where": "all", "move": {"path": [{"at": 0},
     {"at": 0.5, "translation": [1, 0, 0]}]}}}, {"at": 1, "release": "clamp"})");
  const auto& held = std::get<Grasp>(scene.events.at(0).what).held;
  EXPECT_EQ(held.name, "clamp");
  EXPECT_EQ(held.path.stations.back().place[0], 1);
  EXPECT_EQ(scene.events[0].finish(), 0.75);
  EXPECT_EQ(std::get<Release>(scene.events.at(1).what).name, "clamp");
}

INSTANTIATE_TEST_SUITE_P(
    Grasps, EventMistakes,
    ::testing::Values(BadEvent{R"({"at": 0, "release": "clamp"})", "/events/0/release",
                               "no grasp or constraint is named 'clamp'"},
                      BadEvent{R"({"at": 0, "grasp": {"name": "clamp", "where": "all"}},
                    {"at": 0.5, "release": "clmp"})",
                               "/events/1/release", "did you mean 'clamp'"},
                      BadEvent{R"({"at": 0, "grasp": {"name": "a", "where": "all"}},
                    {"at": 0.5, "grasp": {"name": "a", "where": "all"}})",
                               "/events/1/grasp/name", "is the name of another one"},
                      BadEvent{R"({"at": 0, "grasp": {"where": "all"}})", "/events/0/grasp",
                               "'name' is missing"},
                      BadEvent{R"({"at": 0, "grasp": {"name": "a b", "where": "all"}})",
                               "/events/0/grasp/name", "must consist of"},
                      BadEvent{R"({"every": 2, "grasp": {"name": "a", "where": "all"}})",
                               "/events/0/every", "happens once"},
                      BadEvent{R"({"at": 0, "grasp": {"name": "a", "where": "all", "ramp": 1}})",
                               "/events/0/grasp/ramp", "only allowed with 'move'"},
                      BadEvent{R"({"at": 0, "grasp": {"name": "a", "where": "all", "move": {"path":
                    [{"at": 0.2}, {"at": 0.1, "translation": [1, 0, 0]}]}}})",
                               "/events/0/grasp/move/path/1/at", "later than the previous"},
                      BadEvent{R"({"at": 0, "grasp": {"name": "a", "obstacle": "jaw"}})",
                               "/events/0/grasp/obstacle", "the scene has none"},
                      BadEvent{R"({"at": 0, "grasp": {"name": "a"}})", "/events/0/grasp",
                               "exactly one of 'where', 'obstacle'"}));

INSTANTIATE_TEST_SUITE_P(
    When, EventMistakes,
    ::testing::Values(
        BadEvent{R"({"cut": {"faces": [[0, 1]]}})", "/events/0", "exactly one of 'at', "},
        BadEvent{R"({"at": 1, "every": 2, "cut": {"faces": [[0, 1]]}})", "/events/0",
                 "has 'at', 'every'"},
        BadEvent{R"({"at": -0.1, "cut": {"faces": [[0, 1]]}})", "/events/0/at", ">= 0 s"},
        BadEvent{R"({"every": 0, "cut": {"faces": [[0, 1]]}})", "/events/0/every", "1"},
        BadEvent{R"({"every": 2.5, "cut": {"faces": [[0, 1]]}})", "/events/0/every",
                 "whole number"},
        BadEvent{R"({"at": 0, "from": 0, "cut": {"faces": [[0, 1]]}})", "/events/0/from",
                 "'every'"},
        BadEvent{R"({"every": 2, "from": 2, "cut": {"faces": [[0, 1]]}})", "/events/0/from",
                 "after the end"},
        BadEvent{R"({"every": 2, "from": 0.5, "until": 0.4, "cut": {"faces": [[0, 1]]}})",
                 "/events/0/until", "before 'from'"},
        BadEvent{R"({"when": {"of": "velocity", "above": 1}, "cut": {"faces": [[0, 1]]}})",
                 "/events/0/when", "'where' is missing"},
        BadEvent{
            R"({"when": {"where": "all", "of": "speed", "above": 1}, "cut": {"faces": [[0, 1]]}})",
            "/events/0/when/of", "'velocity'"},
        BadEvent{R"({"when": {"where": "all", "of": "velocity"}, "cut": {"faces": [[0, 1]]}})",
                 "/events/0/when", "'above', 'below'"}));

INSTANTIATE_TEST_SUITE_P(
    What, EventMistakes,
    ::testing::Values(
        BadEvent{R"({"at": 0, "cutt": {"faces": [[0, 1]]}})", "/events/0", "exactly one of 'cut'"},
        BadEvent{R"({"at": 0, "cut": {"faces": [[0, 1]], "along": "blade"}})",
                 "/events/0/cut/along", "faces are listed"},
        BadEvent{R"({"at": 0, "cut": {"faces": [[0, 1]], "along": "lips"}})", "/events/0/cut/along",
                 "'faces', 'blade'"},
        BadEvent{
            R"({"at": 0, "cut": {"plane": {"point": [0,0,0], "normal": [1,0,0], "radius": 0}}})",
            "/events/0/cut/plane/radius", "> 0 m"},
        BadEvent{
            R"({"at": 0, "cut": {"plane": {"normal": [1,0,0], "polygon": [[0,0,0],[1,0,0],[0,1,0]]}}})",
            "/events/0/cut/plane/normal", "determined by 'polygon'"},
        BadEvent{R"({"at": 0, "cut": {"plane": {"polygon": [[0,0,0],[1,0,0]]}}})",
                 "/events/0/cut/plane/polygon", "at least 3"},
        BadEvent{R"({"at": 0, "cut": {"plane": {"polygon": [[0,0,0],[1,0,0],[2,0,0]]}}})",
                 "/events/0/cut/plane/polygon", "no area: its points lie on a line"},
        BadEvent{R"({"at": 0, "cut": {"plane": {"polygon": [[0,0,2],[1,1,2],[1,0,2],[0,1,2]]}}})",
                 "/events/0/cut/plane/polygon", "its sides cross"},
        BadEvent{R"({"at": 0, "cut": {"plane": {"polygon": [[0,0,2],[1,1,2],[1,0,2],[0,0.6,2]]}}})",
                 "/events/0/cut/plane/polygon", "its sides cross"},
        BadEvent{R"({"at": 0, "cut": {"plane": {"polygon": [[0,0,0],[1,0,0],[1,1,0.1],[0,1,0]]}}})",
                 "/events/0/cut/plane/polygon", "not planar"},
        BadEvent{R"({"at": 0, "tear": {"by": "elongation", "above": 0.3}, "shape": "rest"})",
                 "/events/0/shape", "has no meaning for tear"},
        BadEvent{R"({"at": 0, "tear": {"by": "elongation"}})", "/events/0/tear",
                 "'above' is missing"},
        BadEvent{R"({"at": 0, "tear": {"by": "elongation", "above": -1}})", "/events/0/tear/above",
                 "> 0"},
        BadEvent{R"({"at": 0, "tear": {"by": "strain", "above": 1}})", "/events/0/tear/by",
                 "principal-strain"},
        BadEvent{R"({"at": 0, "tear": {"by": {"model": "jely", "field": "wobble"}, "above": 1}})",
                 "/events/0/tear/by/model", "did you mean 'jelly'"},
        BadEvent{R"({"at": 0, "tear": {"by": {"model": "jelly", "field": "wobble"}, "above": 1}})",
                 "/events/0/tear/by/field", "has no scalar field"},
        BadEvent{R"({"at": 0, "tear": {"by": "elongation", "above": 1, "most": 1.5}})",
                 "/events/0/tear/most", "<= 1"},
        BadEvent{R"({"at": 0, "cut": {"surface": {"file": "nowhere.stl"}}})",
                 "/events/0/cut/surface/file", "no file"},
        BadEvent{R"({"at": 0, "cut": {"surface": {}}})", "/events/0/cut/surface",
                 "'file' is missing"},
        BadEvent{
            R"({"at": 0, "cut": {"blade": {"path": [{"at": 0, "points": [[0,0,0],[1,0,0]]}]}}})",
            "/events/0/at", "contains its times"},
        BadEvent{R"({"cut": {"blade": {"path": []}}})", "/events/0/cut/blade/path", "is empty"},
        BadEvent{R"({"cut": {"blade": {"path": [{"at": 0, "points": [[0,0,0]]}]}}})",
                 "/events/0/cut/blade/path/0/points", "at least 2"},
        BadEvent{R"({"cut": {"blade": {"path": [{"at": 0.5, "points": [[0,0,0],[1,0,0]]},
                                           {"at": 0.5, "points": [[0,0,0],[1,0,0]]}]}}})",
                 "/events/0/cut/blade/path/1/at", "later than"},
        BadEvent{R"({"cut": {"blade": {"path": [{"at": 0, "points": [[0,0,0],[1,0,0]]},
                                           {"at": 1, "points": [[0,0,0],[1,0,0],[2,0,0]]}]}}})",
                 "/events/0/cut/blade/path/1/points", "must have the same number of points"},
        BadEvent{R"({"cut": {"blade": {"path": [{"at": -1, "points": [[0,0,0],[1,0,0]]}]}}})",
                 "/events/0/cut/blade/path/0/at", ">= 0 s"},
        BadEvent{R"({"cut": {"blade": {"path": [{"at": 2, "points": [[0,0,0],[1,0,0]]}]}}})",
                 "/events/0/cut/blade/path/0/at", "after the end"},
        BadEvent{R"({"at": 0, "pierce": {}})", "/events/0/pierce",
                 "exactly one of 'where', 'path'"},
        BadEvent{R"({"at": 0, "pierce": {"path": [[0,0,0],[1,0,0]]}})", "/events/0/pierce",
                 "'radius' is missing"},
        BadEvent{R"({"at": 0, "pierce": {"where": "all", "radius": 1}})", "/events/0/pierce/radius",
                 "is only allowed with 'path'"},
        BadEvent{R"({"at": 0, "suture": {"between": ["all"], "gap": 1}})",
                 "/events/0/suture/between", "two selections"},
        BadEvent{R"({"at": 0, "suture": {"between": ["all", "all"]}})", "/events/0/suture",
                 "'gap' is missing"},
        BadEvent{R"({"at": 0, "suture": {"faces": [[0, 1]], "where": "all"}})", "/events/0/suture",
                 "one of 'faces'"},
        BadEvent{R"({"at": 0, "suture": {"faces": [[0]]}})", "/events/0/suture/faces/0", "[a, b]"},
        BadEvent{R"({"at": 0, "remove_islands": {}})", "/events/0/remove_islands", "'below'"},
        BadEvent{R"({"at": 0, "remove_islands": {"volume": 0}})", "/events/0/remove_islands/volume",
                 "must be > 0 m^3"},
        BadEvent{R"({"at": 0, "remove_islands": {"below": 2}, "on_failure": "go"})",
                 "/events/0/on_failure", "must be"},
        BadEvent{R"({"at": 0, "remove_islands": {"outside": {}}})",
                 "/events/0/remove_islands/outside", "'box' is missing"}));

struct BadResistance {
  const char *resistance, *contact, *solver;
  const char *path, *words;
};
void PrintTo(const BadResistance& bad, std::ostream* stream) {
  *stream << bad.resistance << bad.contact << bad.solver;
}

std::string knife_scene(const std::string& resistance, const std::string& contact = "",
                        const std::string& solver = R"("end": 1)") {
  return R"({"suture": 1, "mesh": {"box": {"size": [1, 1, 1], "cells": [2, 2, 2]}},
    "models": [{"model": "mss"}], "solver": {)" +
         solver +
         R"(}, "contact": {"obstacles": [{"name": "knife", "sphere": {"centre": [9, 9, 9], "radius": 1}
    )" + contact +
         R"(}]}, "events": [{"cut": {"blade": {"obstacle": "knife",
    "points": [[0, 0, 0], [0, 0, 1]], "resistance": )" +
         resistance + "}}}]}";
}

class ResistanceMistakes : public ::testing::TestWithParam<BadResistance> {};
TEST_P(ResistanceMistakes, AreNamed) {
  const BadResistance& bad = GetParam();
  const std::string error = error_of(knife_scene(bad.resistance, bad.contact, bad.solver));
  EXPECT_NE(error.find("/events/0/cut/blade/resistance" + std::string(bad.path) + ": "),
            std::string::npos)
      << error;
  EXPECT_NE(error.find(bad.words), std::string::npos) << error;
}

constexpr const char *good = R"({"toughness": 1})", *ends = R"("end": 1)";
INSTANTIATE_TEST_SUITE_P(
    All, ResistanceMistakes,
    ::testing::Values(
        BadResistance{"{}", "", ends, "", "'toughness' is missing"},
        BadResistance{R"({"toughness": -1})", "", ends, "/toughness", "> 0 J/m^2"},
        BadResistance{R"({"toughnes": 1})", "", ends, "/toughnes", "did you mean 'toughness'"},
        BadResistance{R"({"toughness": {"elsewhere": 1}})", "", ends, "/toughness",
                      "'regions' is missing"},
        BadResistance{R"({"toughness": 1, "stress": 1})", "", ends, "/stress", "\"thickness\""},
        BadResistance{R"({"toughness": 1, "thickness": 1})", "", ends, "/thickness", "\"stress\""},
        BadResistance{good, "", R"("integrator": "implicit-euler", "dt": 0.1, "end": 1)", "",
                      "explicit steps"},
        BadResistance{good, R"(}], "law": "penalty", "obstacles": [{"name": "knife",
                      "sphere": {"centre": [9, 9, 9], "radius": 1})",
                      ends, "", "law"},
        BadResistance{good, "", R"("end": 1, "sleep": {"acceleration": 1, "velocity": 1})", "",
                      "sleep"}));

TEST(Events, ResistanceIsForATool) {
  const std::string error = error_of(scene_with(R"(, "events": [{"cut": {"blade": {
    "path": [{"at": 0, "points": [[0, 0, 0], [1, 0, 0]]}], "resistance": {"toughness": 1}}}}])"));
  EXPECT_NE(error.find("let an obstacle carry the blade"), std::string::npos) << error;
}

}  // namespace
}  // namespace suture::testing
