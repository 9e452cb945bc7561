// SPDX-License-Identifier: GPL-3.0-or-later
//
// Conduction against closed forms, in whole and cut bars.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "kernel/mesh/box.hpp"
#include "kernel/topology/cell_complex.hpp"
#include "tests/fields/field_scene.hpp"

namespace suture::test {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double diffusivity = 0.5;  // k / c of bar()

const std::string explicit_steps = R"("integrator": "symplectic-euler", "dt": 1e-3, "end": 1)",
                  implicit_steps = R"("integrator": "implicit-euler", "dt": 1e-3, "end": 1)";
const std::string heated =
    R"("fields": [{"field": "temperature", "start": 300}, {"field": "temperature", "fix": 400,
    "where": {"set": "x0"}}])";

/// A bar at 0 whose end x = 0 is set to 1 at t = 0, insulated elsewhere: the series of cosines from
/// the insulated end.
double heated_bar(double x, double t) {
  double sum = 1;
  for (int n = 0; n < 200; ++n) {
    const double w = (n + 0.5) * pi;
    sum -= 2 / w * std::sin(w * x) * std::exp(-w * w * diffusivity * t);
  }
  return sum;
}

class Bars : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Schemes, Bars, testing::Values(explicit_steps, implicit_steps));

TEST_P(Bars, ABarHeatedAtOneEndFollowsTheSeries) {
  FieldRun run(bar(40, GetParam(), heated));
  for (const double t : {0.2, 0.6}) {
    const double error =
        run.run_to(t).error([&](double x) { return 300 + 100 * heated_bar(x, t); });
    EXPECT_LT(error, 0.1) << t;
    RecordProperty("largest error at " + std::to_string(t) + " s, % of the rise",
                   std::to_string(error));
  }
}

TEST_P(Bars, NothingFlowsThroughACut) {
  FieldRun run(bar(40, GetParam(), heated + R"(, "events": [{"at": 0, "cut": {"plane": {"point":
      [0.5, 0, 0], "normal": [1, 0, 0]}}}])"));
  run.run_to(0.1);
  const double t = run.simulation.time();
  double largest = 0, beyond = 0;
  for (Index v = 0; v < run.simulation.attributes().vertex_count(); ++v) {
    const double x = run.simulation.attributes().rest().get(v, 0);
    const Index e = element_of(run.simulation.complex().dart_of(0, v));
    const bool is_beyond = e >= 20;                               // elements are numbered along x
    const double shorter = 300 + 100 * heated_bar(2 * x, 4 * t);  // half as long
    const double expected = is_beyond ? 300 : shorter;
    (is_beyond ? beyond : largest) =
        std::max(is_beyond ? beyond : largest, std::abs(run.value(v) - expected));
  }
  EXPECT_EQ(beyond, 0);
  EXPECT_LT(largest, 0.1);
  RecordProperty("largest error, % of the rise", std::to_string(largest));
}

TEST_P(Bars, ContentIsKeptWhereNothingEnters) {
  FieldRun run(bar(12, GetParam(), R"("fields": [{"field": "temperature", "start": 310, "where":
      {"box": {"min": [0, 0, 0], "max": [0.3, 1, 1]}}}], "events": [{"at": 0.1, "cut": {"plane":
      {"point": [0.5, 0, 0], "normal": [1, 0.2, 0]}}}])"));
  const double before = run.balance().content;
  const FieldBalance after = run.run_to(0.5).balance();
  EXPECT_NEAR(after.content, before, 1e-12 * before);
  EXPECT_NEAR(after.produced, 0, 1e-12 * before);
  EXPECT_NEAR(after.changed, 0, 1e-12 * before);
  EXPECT_EQ(after.inflow, 0);
}

TEST_P(Bars, TheBalanceOfAHeatedBarCloses) {
  FieldRun run(bar(12, GetParam(), heated + R"(, "loads": [])"));
  const double before = run.balance().content;
  const FieldBalance after = run.run_to(0.5).balance();
  EXPECT_GT(after.inflow, 1);
  EXPECT_NEAR(after.content - before, after.inflow, 1e-11 * before);
}

/// A bar of 4 m with n elements per metre, warmed from above, with cuts half through it; steady.
Scene warmed_bar(int n, bool is_cut) {
  std::string cuts;
  for (const char* x : {"1.1", "1.9", "3.1"})
    cuts += std::string(cuts.empty() ? "" : ", ") + R"({"at": 0, "cut": {"plane": {"point": [)" +
            x + R"(, 0.5, 0.2], "normal": [1, 0.02, 0.01], "radius": 0.45}}})";
  const std::string cells = std::to_string(n);
  return field_scene(R"("mesh": {"box": {"size": [4, 1, 1], "cells": [)" + std::to_string(4 * n) +
                     ", " + cells + ", " + cells +
                     R"(]}}, "models": [{"model": "heat", "parameters": {"k": 2, "c": 4,
      "rho": 1}}], "constraints": [{"fix": "xyz", "where": "all"}], "solver": {"static": {"frames":
      1}, "end": 1}, "fields": [{"field": "temperature", "fix": 300, "where": {"set": "x0"}},
      {"field": "temperature", "flux": 30, "where": {"set": "z1"}}], "events": [)" +
                     (is_cut ? cuts : "") + "]");
}

TEST(Conduction, SteadyStatesTakeNoMoreIterationsOnFinerMeshes) {
  for (const bool is_cut : {false, true}) {
    std::vector<std::uint64_t> iterations;
    for (const int n : {8, 16}) {
      FieldRun run(warmed_bar(n, is_cut));
      run.run_to(1);
      EXPECT_GT(run.at(4), 400);
      iterations.push_back(run.equation().iterations().with_multigrid);
    }
    EXPECT_GT(iterations[0], 0u);
    // On another mesh, cuts are other faces.
    EXPECT_LE(iterations[1], is_cut ? 20 : iterations[0] + 2);
  }
}

TEST(Conduction, IsOfSecondOrderInTheSizeOfElements) {
  // cos(pi x) decays with the rate pi^2 k / c.
  const auto error = [](int n) {
    Scene scene =
        bar(n, R"("integrator": "symplectic-euler", "dt": 1e-4, "end": 1)", R"("title": "")");
    FieldRun run(scene);
    for (Index v = 0; v < run.simulation.attributes().vertex_count(); ++v)
      run.equation().set({&v, 1}, std::cos(pi * run.simulation.attributes().rest().get(v, 0)));
    run.run_to(0.1);
    return run.error([](double x) { return std::cos(pi * x) * std::exp(-pi * pi * 0.05); });
  };
  const double coarse = error(4), fine = error(8);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1);
  RecordProperty("order", std::to_string(std::log2(coarse / fine)));
}

TEST(Conduction, ASteadyFluxMakesALinearProfile) {
  FieldRun run(bar(7, R"("static": {"frames": 1})", R"("fields": [{"field": "temperature", "fix":
      300, "where": {"set": "x0"}}, {"field": "temperature", "flux": 50, "where": {"set": "x1"}}])"));
  run.run_to(1);
  EXPECT_LT(run.error([](double x) { return 300 + 50 / 2.0 * x; }), 1e-8);
}

// k (300 - T) / L = h (T - 20) at the end of a bar of length 1 m, k = 2 W/(m K).
TEST(Conduction, ASteadyFilmTakesWhatConductionBrings) {
  for (const double h : {0.0, 3.0, 1e4}) {
    FieldRun run(bar(7, R"("static": {"frames": 1})",
                     R"("fields": [{"field": "temperature", "fix":
        300, "where": {"set": "x0"}}, {"field": "temperature", "film": {"coefficient": )" +
                         std::to_string(h) +
                         R"(, "outside": 20},
        "where": {"set": "x1"}}])"));
    run.run_to(1);
    const double end = (2 * 300 + h * 20) / (2 + h);
    EXPECT_LT(run.error([&](double x) { return 300 + (end - 300) * x; }), 1e-7) << h;
  }
}

// A body whose surface alone resists: C du/dt = h A (outside - u), also after a cut through the
// film. Without a prescribed value, the film determines the steady state.
TEST(Conduction, AFilmCoolsAsAnExponential) {
  const std::string film = R"("fields": [{"field": "temperature", "start": 400},
      {"field": "temperature", "film": {"coefficient": 0.01, "outside": 300}, "where": {"set": "z1"}},
      {"field": "temperature", "film": {"coefficient": 0.01, "outside": 300}, "where": {"set": "z0"}}
      ], "events": [{"at": 0.3, "cut": {"plane": {"point": [0.5, 0, 0], "normal": [1, 0, 0]}}}])";
  for (const std::string& steps : {explicit_steps, implicit_steps}) {
    FieldRun run(bar(4, steps, film));
    const double before = run.balance().content;
    const double rate = 2 * 0.01 / 0.25 / (2 / diffusivity);  // h A / (c V)
    run.run_to(1);
    EXPECT_LT(run.error([&](double) { return 300 + 100 * std::exp(-rate); }), 2e-3) << steps;
    EXPECT_NEAR(run.balance().content - before, run.balance().inflow, 1e-9);
    EXPECT_LT(run.balance().inflow, -0.1);
  }
  FieldRun steady(bar(4, R"("static": {"frames": 1})", film));
  steady.run_to(1);
  EXPECT_LT(steady.error([](double) { return 300; }), 1e-7);
}

// An island without a prescribed value: the multigrid could add any constant to it.
TEST(Conduction, ASteadyIslandKeepsItsContent) {
  FieldRun run(
      bar(160, R"("static": {"frames": 1})", R"("fields": [{"field": "temperature", "start":
      300}, {"field": "temperature", "start": 700, "where": {"set": "x0"}}, {"field": "temperature",
      "fix": 400, "where": {"set": "x1"}}], "events": [{"at": 0, "cut": {"plane": {"point": [0.85,
      0, 0], "normal": [1, 0, 0]}}}])"));
  run.run_to(1);
  ASSERT_GT(run.equation().iterations().with_multigrid, 0u);
  const double mean = 300 + 400 / (0.85 * 320);  // half an element was warm
  EXPECT_NEAR(run.at(0), mean, 1e-6);
  EXPECT_NEAR(run.at(0.5), mean, 1e-6);
  EXPECT_NEAR(run.at(0.95), 400, 1e-6);
}

TEST(Conduction, ALinearProfileIsExactOnDistortedElements) {
  Scene scene = bar(5, R"("static": {"frames": 1})", R"("fields": [{"field": "temperature", "fix":
      0, "where": {"set": "x0"}}, {"field": "temperature", "fix": 1, "where": {"set": "x1"}}])");
  Mesh mesh = make_box({.size = {1, 0.25, 0.25}, .cells = {5, 3, 3}});
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    Vec3& p = mesh.points[i];
    for (std::size_t c = 0; c < 3; ++c) {
      const double length = c == 0 ? 1 : 0.25, edge = c == 0 ? 0.2 : 0.08;
      if (p[c] > 1e-9 && p[c] < length - 1e-9)
        p[c] += 0.3 * edge * std::sin(static_cast<double>(7 * i + 3 * c));
    }
  }
  scene.mesh = {};
  scene.mesh.given = std::make_shared<const Mesh>(std::move(mesh));
  FieldRun run(scene);
  run.run_to(1);
  EXPECT_LT(run.error([](double x) { return x; }), 1e-9);
}

TEST(Conduction, AFluxFillsAnInsulatedBar) {
  FieldRun run(bar(8, implicit_steps, R"("fields": [{"field": "temperature", "flux": 8, "where":
      {"set": "x1"}}, {"field": "temperature", "source": -0.25, "where": {"set": "x0"}}])"));
  const double before = run.balance().content;
  const FieldBalance after = run.run_to(0.5).balance();
  EXPECT_NEAR(after.inflow, 0.5 * (8 * 0.0625 - 0.25), 1e-9);
  EXPECT_NEAR(after.content - before, after.inflow, 1e-9);
}

TEST(Conduction, AValueFollowsItsTable) {
  FieldRun run(bar(4, explicit_steps, R"("fields": [{"field": "temperature", "move": [[0, 300],
      [0.2, 340], [0.4, 320]], "where": {"set": "x0"}}])"));
  EXPECT_NEAR(run.run_to(0.1).at(0), 320, 1e-9);
  EXPECT_NEAR(run.run_to(0.3).at(0), 330, 1e-9);
  EXPECT_NEAR(run.run_to(0.5).at(0), 320, 1e-9);
}

}  // namespace
}  // namespace suture::test
