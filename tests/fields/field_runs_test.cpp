// SPDX-License-Identifier: GPL-3.0-or-later
//
// Fields in runs: threads, checkpoints, operations.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/fields/field_scene.hpp"

namespace suture::test {
namespace {

/// A block that is heated and cut while it moves.
Scene moving_block(unsigned threads, const std::string& integrator) {
  Scene scene = field_scene(
      R"("mesh": {"box": {"size": [0.1, 0.05, 0.05], "cells": [12, 20, 20]}}, "models": [{"model": "heat",
      "parameters": {"k": 0.5, "c": 100}}, {"model": "thermoelastic", "parameters": {"mu": 1e4,
      "lambda": 2e4, "rho": 1000, "alpha": 1e-3, "softening": 2e-3}}], "gravity": [0, -9.8, 0],
      "constraints": [{"fix": "xyz", "where": {"set": "x0"}}], "fields": [{"field": "temperature",
      "fix": 350, "where": {"set": "y1"}}], "events": [{"at": 0.002, "cut": {"plane": {"point":
      [0.05, 0, 0], "normal": [1, 0.1, 0], "radius": 0.04}}}], "solver": {"integrator": ")" +
      integrator + R"(", "dt": 2e-4, "end": 0.01, "threads": )" + std::to_string(threads) + "}");
  return scene;
}

TEST(FieldRuns, HaveTheSameBitsForAnyNumberOfThreads) {
  FieldRun one(moving_block(1, "symplectic-euler")), two(moving_block(2, "symplectic-euler"));
  EXPECT_EQ(one.run_to(0.004).values(), two.run_to(0.004).values());
  EXPECT_GT(one.at(0.05), 293.2);
}

class Resumed : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Schemes, Resumed, testing::Values("symplectic-euler", "implicit-euler"));

TEST_P(Resumed, RunsContinueBitByBit) {
  Scene scene = moving_block(1, GetParam());
  scene.mesh.box->cells = {6, 3, 3};
  FieldRun whole(scene), first(scene), second(scene);
  second.simulation.load(first.run_to(0.003).simulation.save());
  EXPECT_EQ(second.values(), first.values());
  EXPECT_EQ(whole.run_to(0.006).values(), second.run_to(0.006).values());
  EXPECT_EQ(whole.balance().inflow, second.balance().inflow);
}

TEST(FieldRuns, CutsCopyTheValueAndSeamsWeighByCapacity) {
  // The first element is cut off, cools down by a source, and is sewn on again.
  FieldRun run(bar(3, R"("integrator": "symplectic-euler", "dt": 1e-3, "end": 1)",
                   R"("fields": [{"field": "temperature", "source": -0.5, "where": {"set": "x0"}}],
      "events": [{"at": 0, "cut": {"plane": {"point": [0.4, 0, 0], "normal": [1, 0, 0]}}},
      {"at": 0.1, "suture": {"between": [{"ids": [0]}, {"ids": [1]}], "gap": 1e-6}}])"));
  EXPECT_EQ(run.simulation.attributes().vertex_count(), 16u);
  const double capacity = 4 * 0.0625 / 3;  // of an element
  run.run_to(0.0995);
  EXPECT_NEAR(run.balance().content, 293.15 * 3 * capacity - 0.05, 1e-3);
  const double before = run.balance().content;
  run.run_to(0.1015);
  EXPECT_EQ(run.simulation.complex().existing(0), 16u);
  EXPECT_NEAR(run.balance().content, before - 0.0005 * 2, 6e-4);
  EXPECT_NEAR(run.balance().changed, 0, 1e-12 * before);
}

/// A bar whose ends are at two temperatures, cut along an oblique plane that its axis lies in.
Scene split_bar(const std::string& solver, const std::string& ends) {
  return field_scene(R"("mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [8, 3, 3]}}, "models":
      [{"model": "heat", "parameters": {"k": 2, "c": 4, "rho": 1}}], "constraints": [{"fix": "xyz",
      "where": "all"}], "solver": )" +
                     solver +
                     R"(, "fields": [{"field": "temperature", "start": 300, "where": "all"}, )" +
                     ends + R"(], "events": [{"at": 0, "cut": {"plane": {"point": [0, 0.12, 0.11],
      "normal": [0, 1, 0.37]}, "along": "blade"}}])");
}

// Heat flows along the cut, so each half has the profile of the whole bar.
TEST(FieldRuns, PartsConductAsTheWholeElements) {
  const std::string fixed = R"({"field": "temperature", "fix": 300, "where": {"set": "x0"}}, )";
  for (const char* load : {R"({"field": "temperature", "fix": 400, "where": {"set": "x1"}})",
                           R"({"field": "temperature", "flux": 200, "where": {"set": "x1"}})"}) {
    FieldRun cut(
        split_bar(R"({"integrator": "implicit-euler", "dt": 1, "end": 40})", fixed + load));
    cut.run_to(40);
    EXPECT_EQ(cut.simulation.built().body().islands().existing(), 2u);
    EXPECT_GT(cut.simulation.complex().existing(3), 72u);
    EXPECT_LT(cut.error([](double x) { return 300 + 100 * x; }), 1e-6) << load;
  }
}

TEST(FieldRuns, PartsKeepTheContent) {
  FieldRun run(split_bar(R"({"integrator": "symplectic-euler", "dt": 1e-3, "end": 1})",
                         R"({"field": "temperature", "flux": 200, "where": {"set": "z1"}})"));
  run.run_to(0.5);
  const FieldBalance balance = run.balance();
  EXPECT_NEAR(balance.content, 4 * 0.0625 * 300 + 0.5 * 200 * 0.25, 1e-9 * balance.content);
}

TEST(FieldRuns, RemovedElementsTakeTheirContentAlong) {
  FieldRun run(bar(4, R"("integrator": "symplectic-euler", "dt": 1e-3, "end": 1)",
                   R"("events": [{"at": 0.01, "pierce": {"where": {"ids": [3]}}}])"));
  const double before = run.balance().content;
  const FieldBalance after = run.run_to(0.02).balance();
  EXPECT_NEAR(after.content, 0.75 * before, 1e-12 * before);
  EXPECT_NEAR(after.changed, -0.25 * before, 1e-12 * before);
}

}  // namespace
}  // namespace suture::test
