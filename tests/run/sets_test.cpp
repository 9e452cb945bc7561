// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sets that a scene defines: in regions, constraints and events, before and after a cut.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernel/base/error.hpp"
#include "kernel/run/inventory.hpp"
#include "kernel/scene/scene_reader.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test::sets_test {
namespace {

using ::testing::HasSubstr;

/// A bar of 4 x 1 x 1 cubes of 0.25 m.
std::string bar(const std::string& sets, const std::string& more) {
  return R"({"suture": 2, "mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [4, 1, 1]}},
    "sets": )" +
         sets + R"(, "solver": {"dt": 1e-4, "end": 1e-3}, "output": false, )" + more + "}";
}
constexpr const char* two_models = R"("models": [
  {"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}, "region": {"set": "left"}},
  {"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.3, "rho": 3000}, "region": {"set": "right"}}])";
constexpr const char* halves = R"({
  "left": {"box": {"min": [0, 0, 0], "max": [0.5, 1, 1]}},
  "right": {"not": {"set": "left"}},
  "tip": {"and": [{"set": "right"}, {"set": "x1"}]}})";

Scene read(const std::string& text) {
  Diagnostics diagnostics;
  return read_scene_text(text, "s.json", {}, lookup_of(host()), diagnostics);
}
/// The message that refuses a scene.
std::string refusal(const std::string& sets) {
  try {
    TestSimulation simulation(read(bar(sets, two_models)));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SetsOfAScene, GiveRegionsConstraintsAndLoadsTheirCells) {
  TestSimulation simulation(read(bar(halves, std::string(two_models) + R"(,
    "constraints": [{"fix": "xyz", "where": {"set": "tip"}}],
    "loads": [{"pressure": 1000, "where": {"and": [{"set": "left"}, {"set": "z1"}]}},
              {"traction": [0, 8, 0], "where": {"set": "x0"}},
              {"force": [1, 0, 0], "where": {"set": "left"}}])")));
  EXPECT_EQ(take_inventory(simulation.built()),
            (std::vector<std::string>{
                "set 'left': 12 nodes, 2 elements, 0.03125 m^3",
                "set 'right': 8 nodes, 2 elements, 0.03125 m^3",
                "set 'tip': 4 nodes",
                "model 'tm-faure': 2 elements, 0.03125 m^3",
                "model 'tm-faure-2': 2 elements, 0.03125 m^3",
                "load 0: 1000 Pa on 0.125 m^2, [0, 0, -125] N in total",
                "load 1: 8 Pa on 0.0625 m^2, [0, 0.5, 0] N in total",
                "load 2: [1, 0, 0] N on 12 nodes",
            }));
  double mass = 0;
  for (Index v = 0; v < simulation.attributes().mass().size(); ++v)
    mass += simulation.attributes().mass().get(v, 0);
  EXPECT_NEAR(mass, 0.03125 * 4000, 1e-9);
}

// The elements of a set are chosen at rest, and copies belong to the sets of their origins.
TEST(SetsOfAScene, HoldTheCopiesThatACutMakes) {
  TestSimulation simulation(read(bar(halves, std::string(two_models) + R"(,
    "events": [
      {"at": 2e-4, "cut": {"plane": {"polygon": [[-1, -1, 0.1], [2, -1, 0.1], [2, 1, 0.1], [-1, 1, 0.1]]}}},
      {"at": 5e-4, "pierce": {"where": {"set": "left"}}}])")));
  simulation.run();
  const CellComplex& complex = simulation.built().body().complex();
  const RestPlaces rest = simulation.attributes().rest_places(complex);
  double volume = 0, right = 0;
  for (Index e = 0; e < complex.element_count(); ++e) {
    if (!complex.exists(3, e)) continue;
    volume += rest.volume(e);
    if (rest.corner(e, 0)[0] > 0.4) right += rest.volume(e);
  }
  EXPECT_NEAR(right, 0.03125, 1e-12);
  EXPECT_NEAR(volume, right, 1e-12) << "both halves of the elements on the left have gone";
}

TEST(SetsOfAScene, RefuseWhatIsNoSet) {
  EXPECT_THAT(refusal(R"({"left": "all", "right": {"set": "lft"}})"),
              HasSubstr("did you mean 'left'"));
  EXPECT_THAT(
      refusal(R"({"left": {"set": "right"}, "right": "all"})"),
      HasSubstr("/sets/left: uses the set 'right', which is defined below; define it above"));
  EXPECT_THAT(refusal(R"({"left": {"not": {"set": "left"}}, "right": "all"})"),
              HasSubstr("/sets/left: uses the set 'left', which is defined here"));
  EXPECT_THAT(refusal(R"({"x0": "all", "left": "all", "right": "all"})"),
              HasSubstr("/sets/x0: the mesh has a set of this name, too"));
  EXPECT_THAT(refusal(R"({"the left": "all"})"), HasSubstr("/sets/the left: "));
  EXPECT_THAT(refusal(R"({"left": {"and": []}})"), HasSubstr("/sets/left/and: is empty"));
  EXPECT_THAT(
      refusal(R"({"left": {"cylinder": {"from": [0, 0, 0], "to": [0, 0, 0], "radius": 1}}})"),
      HasSubstr("/sets/left/cylinder/to: is the same point as 'from'"));
  EXPECT_THAT(
      refusal(R"({"left": {"sphere": {"centre": [9, 9, 9], "radius": 1}}, "right": "all"})"),
      HasSubstr("/sets/left"));
}

}  // namespace
}  // namespace suture::test::sets_test
