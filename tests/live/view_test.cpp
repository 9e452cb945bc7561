// SPDX-License-Identifier: GPL-3.0-or-later
//
// What pages are told beside the picture: curves, the rest shape, forces, values to change.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernel/forces/contact_law.hpp"
#include "tests/live/watched.hpp"

namespace suture::test {
namespace {

using testing::HasSubstr;

constexpr const char* probed_beam = R"({
  "suture": 1,
  "mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [8, 2, 2]}},
  "models": [{"model": "tm-faure", "name": "beam", "parameters": {"E": 4e5, "nu": 0.3, "rho": 1000}}],
  "gravity": [0, -9.8, 0],
  "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
  "contact": {"obstacles": [{"name": "ball", "sphere": {"centre": [0.5, -0.2, 0.125], "radius": 0.15}}]},
  "solver": {"end": 100, "damping": 2},
  "output": {"every": 0.1, "probes": {"every_steps": 1, "at": [
    {"name": "tip", "where": {"set": "x1"}, "fields": ["displacement", "force"]}]}}
})";

class View : public Watched {
 protected:
  explicit View(const char* scene = beam) : Watched(scene) {}
  std::vector<float> numbers(std::size_t from, std::size_t count) const {
    std::vector<float> numbers(count);
    std::memcpy(numbers.data(), page.arrays().data() + from, 4 * count);
    return numbers;
  }
};

class Curves : public View {
 protected:
  Curves() : View(probed_beam) {}
};

TEST_F(Curves, AreThoseOfTheRun) {
  const Json& plots = greeting["plots"];
  ASSERT_EQ(plots.size(), 4U);
  EXPECT_EQ(plots[0]["curves"], Json({"kinetic", "elastic", "external"}));
  EXPECT_EQ(plots[1]["name"], "force on ball");
  EXPECT_EQ(plots[2],
            Json({{"name", "tip displacement"}, {"unit", "m"}, {"curves", {"x", "y", "z"}}}));
  EXPECT_EQ(plots[3]["unit"], "N");
  std::uint64_t steps = 400;
  step(steps);
  Json head = state_at(steps);
  while (!head.contains("plots") && steps < 450) {  // curves may be due later than a state
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    step(1);
    head = state_at(++steps);
  }
  const Json shown = head["plots"];

  Diagnostics diagnostics;
  Observer nobody;
  Simulation same(scene_, host(), diagnostics);
  same.advance({{}, steps}, nobody);
  const Energies energies = same.energies();
  const Vec3 force = same.contact()->loads()[0].force;
  const Vec3 tip = same.mean_displacement({Selection::Named{"x1"}, ""});
  EXPECT_LT(force[1], -1);  // the beam lies on the ball
  const std::vector<double> expected{energies.kinetic, energies.elastic, energies.external,
                                     force[0],         force[1],         force[2],
                                     tip[0],           tip[1],           tip[2]};
  ASSERT_EQ(shown.size(), 12U);
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(shown[i].get<double>(), expected[i], 1e-12 * std::abs(expected[i]) + 1e-15) << i;
}

TEST_F(View, SendsTheRestShapeWithTheTriangles) {
  const auto rest_of = [&](const Json& surface) {
    const std::size_t before = 4 * surface["faces"].get<std::size_t>() * 4;
    return numbers(before, 3 * surface["points"].get<std::size_t>());
  };
  const Json surface = page.until("corners");
  const std::vector<float> rest = rest_of(surface);
  state_at(0);
  EXPECT_EQ(numbers(0, rest.size()), rest);
  step(50);
  state_at(50);
  EXPECT_NE(numbers(0, rest.size()), rest);
  page.send(cut);
  const Json opened = page.until("corners");
  const std::vector<float> rest_of_lips = rest_of(opened);
  EXPECT_GT(rest_of_lips.size(), rest.size());
  EXPECT_EQ(*std::ranges::max_element(rest_of_lips), 1);  // that of a box of 1 x 0.25 x 0.25 m
}

TEST_F(View, ShowsTheForceOfTheHand) {
  page.send(R"({"do":"grab","at":[0.4,0.25,0.1]})");
  page.send(R"({"do":"drag","to":[0.4,0.29,0.1]})");
  step(60);
  const Json hand = state_at(60)["hand"];
  EXPECT_EQ(hand["place"], Json({0.4, 0.29, 0.1}));
  EXPECT_LT(hand["force"][1], -10);  // N: the body pulls back
  page.send(R"({"do":"let_go"})");
  step(1);
  EXPECT_FALSE(state_at(61).contains("hand"));
  page.send(R"({"do":"take","tool":"ball","at":[0.5,0.3,0.1]})");
  page.send(R"({"do":"drag","to":[0.5,0.15,0.1]})");
  step(200);
  EXPECT_GT(state_at(261)["hand"]["force"][1], 10);
  page.send(R"({"do":"take","tool":"bal","at":[0.5,0.3,0.1]})");
  EXPECT_THAT(page.until("error")["error"], HasSubstr("did you mean 'ball'?"));
}

constexpr const char* bent_cut_along_blade = R"({"do":"apply","event":{"sweep":{"along":"blade",
  "points":[[0.63,-1,-0.1],[0.63,1,-0.1],[0.57,-1,0.1],[0.57,1,0.1],[0.63,-1,0.4],[0.63,1,0.4]],
  "triangles":[[0,1,3],[0,3,2],[2,3,5],[2,5,4]]}}})";

TEST_F(View, CutsWhatABladeHasSwept) {
  const auto cut_by = [&](const Json& sweep) {
    page.send(Json{{"do", "apply"}, {"event", {{"sweep", sweep}}}}.dump());
  };
  Json sweep{{"points", {{0.5, -1, -1}, {0.5, 1, -1}, {0.5, 1, 1}, {0.5, -1, 1}}},
             {"triangles", {{0, 1, 2}, {0, 2, 3}}}};
  cut_by(sweep);
  EXPECT_THAT(page.until("message")["message"], HasSubstr("cut 16 faces, 2 islands"));
  page.send(R"({"do":"apply","event":{"suture":{"where":{"sphere":{
    "centre":[0.5,0.125,0.125],"radius":0.3}}}}})");
  EXPECT_THAT(page.until("message")["message"], HasSubstr("sewed 16 faces, 1 island"));
  const auto refused = [&](const char* key, const Json& value) -> std::string {
    Json wrong = sweep;
    wrong[key] = value;
    cut_by(wrong);
    return page.until("error")["error"];
  };
  EXPECT_THAT(refused("triangles", {{0, 1, 4}}), HasSubstr("corner 4, but 4 points are given"));
  EXPECT_THAT(refused("triangles", {{0, 1, -1}}), HasSubstr("is not a whole number"));
  EXPECT_THAT(refused("points", 7), HasSubstr(R"(expected {"sweep": {"points": [[x, y, z], ...])"));
  EXPECT_THAT(refused("along", "edge"), HasSubstr("\"faces\" or \"blade\""));
  EXPECT_THAT(refused("alon", "blade"), HasSubstr("did you mean 'along'?"));
}

// The run is made again, with what was done so far.
TEST_F(View, CutsAlongBladesWithoutAnEventThatDoes) {
  step(20);
  page.send(R"({"do":"apply","event":{"gravity":[0,-5,0]}})");
  step(30);
  state_at(50);
  page.send(
      R"({"do":"apply","event":{"cut":{"along":"blade","plane":{"point":[0.31,0,0],"normal":[1,0,0.3]}}}})");
  EXPECT_THAT(page.until("message")["message"], HasSubstr("made again, prepared for cuts along"));
  EXPECT_THAT(page.until("message")["message"], HasSubstr("gravity"));
  while (page.until("message")["message"].get<std::string>().find("2 islands") == std::string::npos)
    continue;
  EXPECT_GT(page.until("corners")["laid_open"], 0);
  EXPECT_EQ(page.until("step")["step"], 50);
  page.send(R"({"do":"back"})");
  EXPECT_EQ(page.until("corners")["laid_open"], 0);
  page.send(bent_cut_along_blade);
  EXPECT_GT(page.until("corners")["laid_open"], 0);
  step(30);
  state_at(80);
  page.send(R"({"do":"checkpoint"})");
  while (page.until("message")["message"].get<std::string>().find("saved") == std::string::npos)
    continue;
  const Checkpoint saved = read_checkpoint(folder_ / "beam-checkpoint.h5");
  EXPECT_THAT(saved.header.scene_text, HasSubstr(R"("divisible":true)"));
  stop();
  expect_same_bits(recording());  // up to then
  const std::filesystem::path second = folder_ / "beam-recording.jsonl";
  EXPECT_THAT(read_recording(second).source.text, HasSubstr(R"("divisible":true)"));
  EXPECT_EQ(read_recording(second).inputs.size(), 2U);
  EXPECT_EQ(read_recording(second).last_step, 80U);
  expect_same_bits(second);
}

constexpr const char* bar_and_tool = R"({
  "suture": 1,
  "mesh": {"box": {"size": [1, 0.2, 0.2], "cells": [10, 3, 3]}},
  "models": [{"model": "tm-faure", "parameters": {"E": 4e5, "nu": 0.3, "rho": 1000}}],
  "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
  "contact": {"obstacles": [{"name": "tool", "sphere": {"centre": [0.5, 1, 0.1], "radius": 0.1},
    "path": [{"at": 0}],
    "coupling": {"mass": 1, "stiffness": 1}}]},
  "solver": {"end": 100}
})";

class BesideATool : public View {
 protected:
  BesideATool() : View(bar_and_tool) {}
};

TEST_F(BesideATool, IsCutAlongABlade) {
  step(10);
  page.send(
      R"({"do":"apply","event":{"cut":{"along":"blade","plane":{"point":[0.31,0,0],"normal":[1,0,0.2]}}}})");
  while (page.until("message")["message"].get<std::string>().find("2 islands") == std::string::npos)
    continue;
  EXPECT_EQ(page.until("step")["step"], 10);
}

constexpr const char* sliced_bar = R"({
  "suture": 1,
  "mesh": {"box": {"size": [1, 0.2, 0.2], "cells": [10, 3, 3]}},
  "models": [{"model": "tm-faure", "parameters": {"E": 4e5, "nu": 0.3, "rho": 1000}}],
  "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
  "solver": {"end": 100},
  "events": [{"cut": {"along": "blade", "blade": {"path": [
    {"at": 0, "points": [[0.7, -1, -0.1], [0.7, 1, -0.1]]}, {"at": 100, "points": [[0.7, -1, 0.3], [0.7, 1, 0.3]]}]}}}]
})";

class Sliced : public View {
 protected:
  Sliced() : View(sliced_bar) {}
};

TEST_F(Sliced, ShowsItsBladeAndIsCutAlongAnother) {
  step(100);
  const Json head = state_at(100);
  ASSERT_EQ(head["blades"].size(), 1U);
  EXPECT_NEAR(head["blades"][0][2].get<double>(), -0.1 + 0.4 * head["time"].get<double>() / 100,
              1e-6);
  page.send(
      R"({"do":"apply","event":{"cut":{"along":"blade","plane":{"point":[0.33,0,0],"normal":[1,0,0.3]}}}})");
  EXPECT_THAT(page.until("message")["message"], HasSubstr("2 islands"));
  EXPECT_GT(page.until("corners")["laid_open"], 0);
  page.send(R"({"do":"back"})");
  EXPECT_EQ(page.until("corners")["laid_open"], 0);
  step(1);
  page.send(
      R"({"do":"apply","event":{"cut":{"along":"blade","plane":{"point":[0.37,0,0],"normal":[1,0,0.3]}}}})");
  step(50);
  state_at(151);
  stop();
  EXPECT_EQ(read_recording(recording()).inputs.size(), 1U);
  expect_same_bits(recording());
}

TEST_F(View, ChangesModelsAndGravity) {
  const auto parameter = [](const Json& values, const std::string& name) {
    for (const Json& one : values["models"][0]["parameters"])
      if (one["name"] == name) return one;
    return Json();
  };
  EXPECT_EQ(parameter(greeting["values"], "E")["value"], 4e5);
  EXPECT_EQ(parameter(greeting["values"], "E")["unit"], "Pa");
  page.until("values");  // those of the start
  const auto change = [&](const Json& event) {
    page.send(Json{{"do", "apply"}, {"event", event}}.dump());
  };
  const auto next_values = [&](auto&& is_so) {
    for (;;)
      if (const Json values = page.until("values")["values"]; is_so(values)) return values;
  };
  change({{"parameters", {{"model", "tm-faure"}, {"values", {{"E", 2e5}}}}}});
  next_values([&](const Json& values) { return parameter(values, "E")["value"] == 2e5; });
  change({{"gravity", {0, -1, 0}}});
  next_values([&](const Json& values) { return values["gravity"] == Json({0, -1, 0}); });
  const std::vector<std::pair<Json, const char*>> wrong{
      {{{"gravity", {0, -1}}}, R"(: {"gravity":[0,-1]}; expected {"gravity": [x, y, z]})"},
      {{{"gravity", "moon"}}, R"(expected {"gravity": [x, y, z]})"},
      {{{"parameters", {{"model", "tm-faur"}, {"values", {{"E", 2e5}}}}}},
       "did you mean 'tm-faure'?"},
      {{{"parameters", {{"model", "tm-faure"}, {"values", {{"E", -1}}}}}}, "must be"},
      {{{"parameters", {{"model", "tm-faure"}, {"values", {{"F", 1}}}}}}, "unknown key"},
      {{{"parameters", {{"model", "tm-faure"}, {"value", {{"E", 1}}}}}}, "did you mean 'values'?"},
      {{{"steer", {{"obstacle", "ball"}, {"during", "long"}}}},
       R"(expected {"steer": {"obstacle": NAME,)"}};
  for (const auto& [event, message] : wrong) {
    change(event);
    EXPECT_THAT(page.until("error")["error"], HasSubstr(message)) << event;
  }
  page.send(R"({"do":"back"})");
  next_values([&](const Json& values) { return values["gravity"] == Json({0, -9.8, 0}); });
  step(30);
  state_at(30);
  stop();
  ASSERT_EQ(read_recording(recording()).inputs.size(), 1U);
  expect_same_bits(recording());
}

}  // namespace
}  // namespace suture::test
