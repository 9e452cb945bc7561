// SPDX-License-Identifier: GPL-3.0-or-later
//
// One clear message for each mistake.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernel/base/error.hpp"
#include "tests/fields/field_scene.hpp"

namespace suture::test {
namespace {

using testing::AllOf, testing::HasSubstr, testing::Not;

std::string message(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::string of_bar(
    const std::string& fields,
    const std::string& solver = R"("integrator": "implicit-euler", "dt": 0.1, "end": 1)") {
  return message([&] { FieldRun(bar(2, solver, R"("fields": [)" + fields + "]")); });
}

TEST(FieldMistakes, NameThePlaceAndTheNearestName) {
  EXPECT_THAT(of_bar(R"({"field": "temprature", "start": 3})"),
              HasSubstr("/fields/0/field: must be one of 'temperature', is the string 'temprature' "
                        "(did you mean 'temperature'?)"));
  EXPECT_THAT(of_bar(R"({"field": "temperature", "fix": 3})"), HasSubstr("/fields/0: 'where'"));
  EXPECT_THAT(of_bar(R"({"field": "temperature", "flox": 3, "ramp": 1, "where": {"set": "x0"}})"),
              AllOf(HasSubstr("/fields/0/flox: unknown key (did you mean 'flux'?)"),
                    HasSubstr("2 mistakes"), Not(HasSubstr("/fields/0/ramp"))));
  EXPECT_THAT(of_bar(R"({"field": "temperature", "move": [[1, 2], [1, 3]], "where": "all"})"),
              HasSubstr("/fields/0/move/1: must be later"));
  EXPECT_THAT(of_bar(R"({"field": "temperature", "fix": 3, "where": {"set": "x0"}}, {"field":
                     "temperature", "fix": 4, "where": {"set": "y0"}})"),
              HasSubstr("/fields/1: prescribes another 'temperature' than an earlier condition at "
                        "node"));
  EXPECT_THAT(of_bar(R"({"field": "temperature", "fix": 3, "ramp": 1, "where": {"set": "x0"}})"),
              HasSubstr("/fields/0/ramp: belongs to"));
}

TEST(FieldMistakes, NameTheRangeOfTheField) {
  EXPECT_THAT(of_bar(R"({"field": "temperature", "start": -1})"),
              HasSubstr("/fields/0/start: must be >= 0 K"));
  EXPECT_THAT(of_bar(R"({"field": "temperature", "move": [[0, 1], [1, -2]], "where": "all"})"),
              HasSubstr("/fields/0/move/1/1: must be >= 0 K"));
  EXPECT_EQ(of_bar(R"({"field": "temperature", "flux": -1, "where": {"set": "x0"}})"), "");
  EXPECT_THAT(of_bar(R"({"field": "temperature", "film": {"coefficient": 1}, "where": {"set":
      "x0"}})"),
              HasSubstr("/fields/0/film: 'outside' is missing"));
  EXPECT_THAT(of_bar(R"({"field": "temperature", "film": {"coefficient": -1, "outside": 300},
      "where": {"set": "x0"}})"),
              HasSubstr("/fields/0/film/coefficient"));
}

TEST(FieldMistakes, NameBothEndsOfTheRangeOfDamage) {
  for (const char* condition : {R"("start": -0.1)", R"("fix": 2)"})
    EXPECT_THAT(message([&] {
                  field_scene(R"("mesh": {"box": {"size": [1, 1, 1], "cells": [1, 1, 1]}}, "solver":
                      {"integrator": "implicit-euler", "dt": 1, "end": 1}, "models": [{"model":
                      "gradient-damage", "parameters": {"mu": 1, "K": 1, "rho": 1, "Gc": 1, "l": 1}}],
                      "fields": [{"field": "damage", )" +
                              std::string(condition) + R"(, "where": "all"}])");
                }),
                HasSubstr("must be >= 0 and <= 1"));
}

TEST(FieldMistakes, SayWhatTheSceneLacks) {
  const std::string mesh = R"("mesh": {"box": {"size": [1, 1, 1], "cells": [1, 1, 1]}}, "solver":
      {"integrator": "symplectic-euler", "dt": 1e-3, "end": 1}, )";
  EXPECT_THAT(
      message([&] {
        field_scene(mesh +
                    R"("models": [{"model": "tm-faure", "parameters": {"E": 1, "nu": 0, "rho":
                    1}}], "fields": [{"field": "temperature", "start": 3}])");
      }),
      HasSubstr("/fields/0: no model of this scene declares a field"));
  EXPECT_THAT(message([&] {
                field_scene(mesh + R"("models": [{"model": "thermoelastic", "parameters": {"mu": 1,
                    "lambda": 0, "rho": 1}}], "fields": [{"field": "temperature", "flux": 3, "where":
                    {"set": "x0"}}])");
              }),
              HasSubstr("/fields/0/flux: no model of this scene changes"));
  EXPECT_THAT(message([&] {
                field_scene(mesh + R"("models": [{"model": "heat", "parameters": {"k": 1, "c": 1}},
                    {"model": "thermoelastic", "parameters": {"mu": 1, "lambda": 0, "rho": 1}}],
                    "fields": [{"field": "temprature", "start": 3}])");
              }),
              HasSubstr("must be one of 'temperature', is the string"))
      << "a name that two models declare is given once";
  EXPECT_THAT(of_bar("", R"("integrator": "symplectic-euler", "until": "rest")"),
              HasSubstr("/solver: \"until\": \"rest\" looks at the motion alone"));
}

TEST(FieldMistakes, NameWhatFlowsWhereNoModelTakesItFurther) {
  for (const char* flow :
       {R"("flux": 1, "where": {"set": "x1"})", R"("source": 1, "where": {"set": "x1"})"})
    for (const char* solver : {R"("integrator": "symplectic-euler", "dt": 1e-3, "end": 1)",
                               R"("static": {"frames": 1})"})
      EXPECT_THAT(
          message([&] {
            FieldRun(field_scene(
                R"("mesh": {"box": {"size": [2, 1, 1], "cells": [2, 1, 1]}}, "models": [{"model":
                "tm-faure", "parameters": {"E": 1, "nu": 0, "rho": 1}}, {"model": "heat",
                "parameters": {"k": 1, "c": 1}, "region": {"box": {"min": [0, 0, 0], "max":
                [1, 1, 1]}}}], "fields": [{"field": "temperature", )" +
                std::string(flow) + R"(}], "solver": {)" + solver + "}"));
          }),
          HasSubstr("/fields/0: 'temperature' flows into node"))
          << flow << solver;
}

TEST(FieldMistakes, ASteadyStateNeedsAPrescribedValue) {
  for (const int n : {2, 160}) {  // with and without the multigrid
    const Scene scene = bar(n, R"("static": {"frames": 1})", R"("fields": [{"field": "temperature",
        "flux": 1, "where": {"set": "x0"}}])");
    EXPECT_THAT(
        message([&] { FieldRun(scene).run_to(1); }),
        HasSubstr("the equations of field 'temperature' are not solved: a steady state needs a "
                  "prescribed value"));
  }
}

}  // namespace
}  // namespace suture::test
