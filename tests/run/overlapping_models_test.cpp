// SPDX-License-Identifier: GPL-3.0-or-later
//
// Two models on the same elements: an error, one in place of the other, or both.
#include <gtest/gtest.h>

#include "kernel/base/error.hpp"
#include "kernel/build/built_scene.hpp"
#include "kernel/scene/scene_reader.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/host.hpp"

namespace suture::test::overlapping_models_test {
namespace {

/// A cube of 1 m and 4 x 4 x 4 elements of 1000 kg/m^3; `more`: further models.
struct Built {
  explicit Built(const std::string& more, const std::string& first_region = "\"all\"") {
    const TemporaryFolder folder;
    const auto file = folder.write("s.json", R"({"suture": 2,
      "mesh": {"box": {"size": [1, 1, 1], "cells": [4, 4, 4]}},
      "models": [{"model": "neo-hookean", "name": "liver", "region": )" +
                                                 first_region + R"(,
                  "parameters": {"E": 1e4, "nu": 0.4, "rho": 1000}})" +
                                                 more + R"(],
      "solver": {"end": 1}, "output": false})");
    scene = read_scene(file, {}, host(), diagnostics);
    built.emplace(scene, diagnostics);
  }
  double mass() {
    double sum = 0;
    Column& mass = built->body().attributes().mass();
    for (Index v = 0; v < mass.size(); ++v) sum += mass.get(v, 0);
    return sum;
  }

  Diagnostics diagnostics;
  Scene scene;
  std::optional<BuiltScene> built;
};

std::string tumour(const std::string& keys, const std::string& region = R"({"half_space": {
    "point": [0.5, 0, 0], "normal": [-1, 0, 0]}})") {
  return R"(, {"model": "neo-hookean", "name": "tumour", )" + keys + R"("region": )" + region +
         R"(, "parameters": {"E": 4e4, "nu": 0.4, "rho": 1200}})";
}

std::string error_of(const std::string& more) {
  try {
    Built built(more);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(OverlappingModels, OneIsInPlaceOfTheOther) {
  EXPECT_NEAR(Built(tumour(R"("over": "liver", )")).mass(), 500 + 600, 1e-9);
}

TEST(OverlappingModels, BothCountIfTheSceneSaysSo) {
  EXPECT_NEAR(Built(tumour(R"("adds": true, )")).mass(), 1000 + 600, 1e-9);
}

// The masses of both would count without a word.
TEST(OverlappingModels, TwoDensitiesAreAnError) {
  const std::string error = error_of(tumour(""));
  EXPECT_NE(
      error.find("/models/1: 'tumour' and 'liver' both have a density on 32 elements (0.5 m^3)"),
      std::string::npos)
      << error;
  EXPECT_NE(error.find("\"over\": \"liver\""), std::string::npos) << error;
}

// A model without a density, or with none here, acts beside others.
TEST(OverlappingModels, AModelWithoutADensityActsBesideOthers) {
  EXPECT_NEAR(Built(R"(, {"model": "volume", "parameters": {"kappa": 1e5}})").mass(), 1000, 1e-9);
}

TEST(OverlappingModels, RegionsThatOnlyTouchAreApart) {
  const std::string half = R"({"half_space": {"point": [0.5, 0, 0], "normal": [1, 0, 0]}})";
  EXPECT_NEAR(Built(tumour(""), half).mass(), 500 + 600, 1e-9);
}

// Three models, each over the one before: the last one stands where all are.
TEST(OverlappingModels, AThirdReplacesTheSecond) {
  const std::string third =
      R"(, {"model": "neo-hookean", "name": "core", "over": "tumour", "region":
    {"half_space": {"point": [0.25, 0, 0], "normal": [-1, 0, 0]}}, "parameters": {"rho": 2000, "E": 1, "nu": 0}})";
  EXPECT_NEAR(Built(tumour(R"("over": "liver", )") + third).mass(), 500 + 300 + 500, 1e-9);
}

TEST(OverlappingModels, MistakesNameWhatIsWrong) {
  const auto says = [](const std::string& more, const char* words) {
    const std::string error = error_of(more);
    EXPECT_NE(error.find(words), std::string::npos) << error;
  };
  says(tumour(R"("over": "livre", )"), "/models/1/over");
  says(tumour(R"("over": "livre", )"), "'liver'");
  says(tumour(R"("over": "liver", "adds": true, )"), "contradicts 'over'");
  says(tumour(R"("over": "liver", )", "\"all\""), "replaces 'liver' on all of its elements");
}

}  // namespace
}  // namespace suture::test::overlapping_models_test
