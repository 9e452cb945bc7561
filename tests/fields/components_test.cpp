// SPDX-License-Identifier: GPL-3.0-or-later
//
// A field with several components: two species that diffuse.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "kernel/base/error.hpp"
#include "kernel/scene/scene_reader.hpp"
#include "tests/fields/field_scene.hpp"

namespace suture::test {
namespace {

/// A bar of 1 m of n x 1 x 1 elements that both diffuse in, with 0.5 and 0.125 m^2/s.
Scene bar_of_two(int n, double exchange, const std::string& solver, const std::string& fields,
                 const std::string& more = R"("output": false)") {
  static const bool is_loaded = (plugins().add_file(TEST_PLUGINS "/two-species.so"), true);
  EXPECT_TRUE(is_loaded);
  Diagnostics diagnostics;
  return read_scene_text(
      R"({"suture": 1, "mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [)" + std::to_string(n) +
          R"(, 1, 1]}}, "models": [{"model": "two-species", "parameters": {"k0":
      0.5, "k1": 0.125, "rho": 1, "exchange": )" +
          std::to_string(exchange) +
          R"(}}], "constraints": [{"fix": "xyz", "where": "all"}], "solver": {)" + solver +
          R"(}, "fields": [)" + fields + "], " + more + "}",
      "species.json", {}, lookup_of(plugins()), diagnostics);
}

const std::string schemes[] = {R"("integrator": "symplectic-euler", "dt": 1e-3, "end": 1)",
                               R"("integrator": "implicit-euler", "dt": 1e-3, "end": 1)"};

double value_of(FieldRun& run, Index v, int component) {
  return run.simulation.attributes().fields().front().values->get(v, component);
}

TEST(Components, DiffuseEachAtItsOwnRate) {
  // cos(pi x) decays with the rate pi^2 k, in both.
  for (const std::string& solver : schemes) {
    FieldRun run(bar_of_two(40, 0, solver, ""));
    const Column& rest = run.simulation.attributes().rest();
    for (Index v = 0; v < rest.size(); ++v)
      for (const std::size_t c : {0, 1})
        run.equation().set({&v, 1}, 2 + std::cos(std::numbers::pi * rest.get(v, 0)), c);
    run.run_to(0.2);
    for (Index v = 0; v < rest.size(); ++v)
      for (const int c : {0, 1}) {
        const double left =
            std::exp(-std::numbers::pi * std::numbers::pi * (c == 0 ? 0.5 : 0.125) * 0.2);
        EXPECT_NEAR(value_of(run, v, c), 2 + left * std::cos(std::numbers::pi * rest.get(v, 0)),
                    3e-3);
      }
  }
}

TEST(Components, ExchangeWhatOneHasMoreOf) {
  for (const std::string& solver : schemes) {
    FieldRun run(bar_of_two(4, 3, solver, R"({"field": "species", "component": 0, "start": 2})"));
    run.run_to(0.25);
    const double difference = 2 * std::exp(-2 * 3 * 0.25);
    EXPECT_NEAR(value_of(run, 0, 0), 1 + difference / 2, 4e-3);
    EXPECT_NEAR(value_of(run, 0, 1), 1 - difference / 2, 4e-3);
    EXPECT_NEAR(run.equation().balance(0).produced, -run.equation().balance(1).produced, 1e-12);
    EXPECT_NEAR(run.equation().balance(0).content + run.equation().balance(1).content, 2 * 0.0625,
                1e-12);
  }
}

TEST(Components, HaveConditionsAndABalanceOfTheirOwn) {
  const std::string fields = R"({"field": "species", "component": 0, "fix": 4, "where": {"set":
      "x0"}}, {"field": "species", "component": 1, "flux": 2, "where": {"set": "x1"}},
      {"field": "species", "component": 0, "move": [[0, 0], [0.1, 1]], "where": {"set": "x1"}})";
  FieldRun steady(bar_of_two(
      10, 0, R"("static": {"frames": 1})",
      fields + R"(, {"field": "species", "component": 1, "fix": 0, "where": {"set": "x0"}})"));
  steady.run_to(1);
  const Column& rest = steady.simulation.attributes().rest();
  for (Index v = 0; v < rest.size(); ++v) {
    EXPECT_NEAR(value_of(steady, v, 0), 4 - 3 * rest.get(v, 0), 1e-9);
    EXPECT_NEAR(value_of(steady, v, 1), 2 / 0.125 * rest.get(v, 0), 1e-9);
  }
  FieldRun run(bar_of_two(10, 0, schemes[1], fields));
  run.run_to(0.3);
  const FieldBalance first = run.equation().balance(0), second = run.equation().balance(1);
  EXPECT_NEAR(second.inflow, 0.3 * 2 * 0.0625, 1e-12);
  EXPECT_NEAR(second.content, second.inflow, 1e-12);
  EXPECT_GT(first.inflow, 0.01);
  EXPECT_NEAR(first.content, 4.0 / 20 * 0.0625 + first.inflow, 1e-12);
  EXPECT_THAT(run.equation().balance_text(0.3),
              testing::AllOf(testing::HasSubstr("species 0: content"),
                             testing::HasSubstr("species 1: content")));
}

TEST(Components, KeepTheirSumWhereTheyMeetAndNothingEnters) {
  FieldRun run(bar_of_two(160, 3, R"("static": {"frames": 1})",
                          R"({"field": "species", "component": 0, "start": 2},
      {"field": "species", "component": 1, "start": 8, "where": {"set": "x1"}})"));
  run.run_to(1);
  for (Index v = 0; v < run.simulation.attributes().vertex_count(); ++v)
    for (const int c : {0, 1}) EXPECT_NEAR(value_of(run, v, c), 1 + 8 / 320.0 / 2, 1e-7);
}

TEST(Components, FollowCutsAndSeamsAndAreSaved) {
  const std::string fields = R"({"field": "species", "component": 0, "start": 2, "where": {"set":
      "x0"}}, {"field": "species", "component": 1, "start": 3, "where": {"set": "x1"}})";
  const std::string events = R"("output": false, "events": [{"at": 0.05, "cut": {"plane": {"point":
      [0.5, 0, 0], "normal": [1, 0, 0]}}}])";
  FieldRun whole(bar_of_two(4, 0, schemes[1], fields, events)),
      first(bar_of_two(4, 0, schemes[1], fields, events)),
      second(bar_of_two(4, 0, schemes[1], fields, events));
  second.simulation.load(first.run_to(0.1).simulation.save());
  whole.run_to(0.2);
  second.run_to(0.2);
  for (Index v = 0; v < whole.simulation.attributes().vertex_count(); ++v)
    for (const int c : {0, 1}) EXPECT_EQ(value_of(whole, v, c), value_of(second, v, c));
  for (const std::size_t c : {0, 1}) {
    const FieldBalance after = second.equation().balance(c);
    EXPECT_NEAR(after.content, (c == 0 ? 2.0 : 3.0) / 8 * 0.0625, 1e-12);
    EXPECT_NEAR(after.changed, 0, 1e-15);
  }
}

TEST(Components, AreProbedAndWritten) {
  const std::string folder = testing::TempDir() + "/two-species";
  Scene scene =
      bar_of_two(4, 0, R"("integrator": "implicit-euler", "dt": 0.1, "end": 0.2)",
                 R"({"field": "species", "component": 1, "start": 3})",
                 R"("output": {"every": 0.1, "fields": ["species"], "probes": {"every_steps":
      1, "at": [{"name": "middle", "point": [0.5, 0, 0], "fields": ["species"]}]}, "energies":
      {"every_steps": 1}})");
  scene.output.directory = folder;
  FieldRun(scene).run_to(0.2);
  std::string line;
  std::ifstream probes(folder + "/probes.csv"), energies(folder + "/energies.csv");
  std::getline(probes, line);
  EXPECT_THAT(line,
              testing::AllOf(testing::HasSubstr("species 0 ["), testing::HasSubstr("species 1 [")));
  std::getline(probes, line);
  EXPECT_THAT(line, testing::HasSubstr(",0,3"));
  std::getline(energies, line);
  EXPECT_THAT(line, testing::HasSubstr("species 1 content [mol]"));
}

TEST(Components, AreNamedByConditions) {
  const auto message = [](const std::string& fields) -> std::string {
    try {
      bar_of_two(2, 0, schemes[1], fields);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message(R"({"field": "species", "start": 1})"),
              testing::HasSubstr("/fields/0: 'component' is missing: which one of 'species', 0 to "
                                 "1"));
  EXPECT_THAT(message(R"({"field": "species", "component": 2, "start": 1})"),
              testing::HasSubstr("/fields/0/component: must be"));
  EXPECT_THAT(message(R"({"field": "species", "component": 1, "start": -1})"),
              testing::HasSubstr("/fields/0/start: must be >= 0 mol/m^3"));
}

}  // namespace
}  // namespace suture::test
