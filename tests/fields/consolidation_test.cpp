// SPDX-License-Identifier: GPL-3.0-or-later
//
// A porous solid against the closed forms of Terzaghi.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "kernel/base/error.hpp"
#include "tests/fields/field_scene.hpp"

namespace suture::test {
namespace {

constexpr double quarter = std::numbers::pi / 2;  // of a wave
constexpr double confined = 4e6;                  // lambda + 2 mu of column(), Pa

std::string text_of(double x) {
  std::ostringstream text;
  text << x;
  return text.str();
}

/// A column of 1 m of n elements that deforms along its axis alone; its top, x = 1, is drained.
/// `mobility`, `storage`: of the model.
Scene column(int n, double dt, double mobility, double storage, const std::string& more) {
  return field_scene(
      R"("mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [)" + std::to_string(n) +
      R"(, 1, 1]}}, "models": [{"model": "porous", "parameters": {"mu": 1e6, "lambda": 2e6,
      "rho": 1e-3, "k": )" +
      text_of(mobility) + R"(, "S": )" + text_of(storage) +
      R"(}}], "constraints": [{"fix": "x", "where": {"set": "x0"}}, {"fix": "yz", "where":
      "all"}], "solver": {"integrator": "implicit-euler", "dt": )" +
      text_of(dt) + R"(, "end": 10}, )" + more);
}

const std::string loaded = R"("loads": [{"traction": [-1000, 0, 0], "where": {"set": "x1"}}],
    "fields": [{"field": "pressure", "fix": 0, "where": {"set": "x1"}}])";

/// The pressure of a layer of 1 m under a load of 1, at the distance z from its drained top, at the
/// time T = c t / H^2.
double terzaghi(double z, double T) {
  double sum = 0;
  for (int m = 0; m < 200; ++m) {
    const double w = (2 * m + 1) * quarter;
    sum += 2 / w * std::sin(w * z) * std::exp(-w * w * T);
  }
  return sum;
}

TEST(Consolidation, FollowsTerzaghi) {
  // c = k (lambda + 2 mu) = 0.4 m^2/s
  FieldRun run(column(20, 2e-3, 1e-7, 0, loaded));
  for (const double t : {0.1, 0.5}) {
    run.run_to(t);
    const double T = 0.4 * run.simulation.time();
    const double error = run.error([&](double x) { return 1000 * terzaghi(1 - x, T); });
    EXPECT_LT(error, 10) << t;
    RecordProperty("largest error at " + std::to_string(t) + " s, % of the load",
                   std::to_string(error / 10));
    double settled = 1;
    for (int m = 0; m < 200; ++m) {
      const double w = (2 * m + 1) * quarter;
      settled -= 2 / (w * w) * std::exp(-w * w * T);
    }
    Selection top;
    top.what = Selection::Nearest{Vec3{1, 0, 0}};
    EXPECT_NEAR(run.simulation.mean_displacement(top)[0], -1000 / confined * settled,
                0.01 * 1000 / confined)
        << t;
  }
}

/// The same column of 12 x 2 x 2 elements, loaded, that a blade divides along its axis if it is
/// cut.
Scene wide_column(const std::string& element, bool is_cut) {
  return field_scene(
      R"("mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [12, 2, 2]}}, "models": [{"model":
      "porous", "parameters": {"mu": 1e6, "lambda": 2e6, "rho": 1e-3, "k": 1e-7, "S": 1e-7, "element": ")" +
      element +
      R"("}}], "constraints": [{"fix": "x", "where": {"set": "x0"}}, {"fix": "yz", "where": "all"}],
      "solver": {"integrator": "implicit-euler", "dt": 0.02, "end": 10}, )" +
      loaded +
      (is_cut
           ? R"(, "events": [{"at": 0, "cut": {"plane": {"point": [0, 0.12, 0.11], "normal": [0, 1,
      0.37]}, "along": "blade"}}])"
           : ""));
}

/// The mean over the vertices at this x at rest, by the fluid that they hold: nodes of parts may
/// lie outside of them.
double mean_at(FieldRun& run, double x) {
  const Attributes& attributes = run.simulation.attributes();
  const Column& room = *attributes.fields().front().capacity;
  double sum = 0, all = 0;
  for (Index v = 0; v < room.size(); ++v) {
    if (std::abs(run.simulation.attributes().rest().get(v, 0) - x) > 1e-9) continue;
    sum += room.get(v, 0) * run.value(v);
    all += room.get(v, 0);
  }
  return sum / all;
}

TEST(Consolidation, IsThatOfAColumnInEveryElementAndInParts) {
  FieldRun trilinear(wide_column("trilinear", false));
  trilinear.run_to(0.1);
  EXPECT_GT(trilinear.at(0), 500);
  for (const char* element : {"trilinear", "mean-gradient"}) {
    FieldRun whole(wide_column(element, false)), cut(wide_column(element, true));
    whole.run_to(0.1);
    cut.run_to(0.1);
    EXPECT_GT(cut.simulation.complex().existing(3), 48u);
    for (int i = 0; i <= 12; ++i) {
      EXPECT_NEAR(mean_at(cut, i / 12.0), whole.at(i / 12.0), 20) << element << i;
      EXPECT_NEAR(whole.at(i / 12.0), trilinear.at(i / 12.0), 10) << element << i;
    }
  }
}

TEST(Consolidation, IsOfSecondOrderInTheSizeOfElements) {
  // A pressure cos(pi x / 2) in a solid at rest: the solid takes up its part at once, and each step
  // divides what is left by 1 + c (pi/2)^2 dt.
  constexpr double storage = 2.5e-7, dt = 0.02;
  const double c = 1e-7 / (storage + 1 / confined), decay = 1 + c * quarter * quarter * dt;
  const auto error = [&](int n) {
    FieldRun run(column(n, dt, 1e-7, storage, R"("fields": [{"field": "pressure", "fix": 0, "where":
        {"set": "x1"}}])"));
    for (Index v = 0; v < run.simulation.attributes().vertex_count(); ++v)
      run.equation().set({&v, 1}, std::cos(quarter * run.simulation.attributes().rest().get(v, 0)));
    run.run_to(0.2);
    const double left = 0.5 * std::pow(decay, -std::round(run.simulation.time() / dt));
    return run.error([&](double x) { return left * std::cos(quarter * x); });
  };
  const double coarse = error(4), fine = error(8);
  EXPECT_LT(coarse, 0.02);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.15);
}

TEST(Consolidation, PressuresDoNotAlternateWhereNothingFlows) {
  FieldRun run(column(20, 1e-3, 1e-15, 0, loaded));
  run.run_to(0.002);
  for (Index v = 0; v < run.simulation.attributes().vertex_count(); ++v) {
    const double x = run.simulation.attributes().rest().get(v, 0);
    EXPECT_NEAR(run.value(v), x < 0.99 ? 1000 : 0, 2) << x;
  }
}

TEST(Consolidation, GoesOnUntilNothingIsLeft) {
  // The slowest wave is left; each step divides it by 1 + c (pi/2)^2 dt, up to pressures that the
  // tolerance of the motion does not see.
  constexpr double dt = 0.05;
  FieldRun run(column(10, dt, 1e-6, 0, loaded));
  const double first = run.run_to(1).at(0), second = run.run_to(1.5).at(0);
  EXPECT_LT(first, 1);
  EXPECT_NEAR(std::log(first / second) / (10 * std::log(1 + 4 * quarter * quarter * dt)), 1, 0.02);
  run.run_to(4);
  EXPECT_LT(std::abs(run.at(0)), 1e-3);
  Selection top;
  top.what = Selection::Nearest{Vec3{1, 0, 0}};
  EXPECT_NEAR(run.simulation.mean_displacement(top)[0] * confined / -1000, 1, 1e-3);
}

TEST(Consolidation, IsRefusedWithStepsThatDoNotGiveItsRate) {
  const auto message = [](const auto& change) -> std::string {
    Scene scene = column(2, 0.01, 1e-7, 0, loaded);
    change(scene.solver);
    try {
      FieldRun run(scene);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  for (const char* integrator : {"newmark", "velocity-verlet"})
    EXPECT_THAT(message([&](auto& solver) { solver.integrator = integrator; }),
                testing::AllOf(testing::HasSubstr("/solver/integrator: field 'pressure'"),
                               testing::HasSubstr("choose \"implicit-euler\"")));
  EXPECT_THAT(message([](auto& solver) {
                solver.budget = StepBudget{50, 0};
              }),
              testing::HasSubstr("/solver/budget: field 'pressure' is solved in turns"));
  EXPECT_EQ(message([](auto&) {}), "");
}

TEST(Consolidation, TheEnergyOfSolidAndFluidCloses) {
  // Fluid leaves through the loaded end against a pressure.
  const std::string held = R"("loads": [{"traction": [-1000, 0, 0], "where": {"set": "x1"}, "ramp":
      0.2}], "fields": [{"field": "pressure", "move": [[0, 0], [0.2, 200]], "where": {"set": "x1"}}])";
  const auto missing = [&](double dt) {
    FieldRun run(column(10, dt, 1e-7, 1e-7, held));
    const double before = run.energy().stored;
    run.run_to(0.4);
    const FieldEnergy after = run.energy();
    double work = 0;
    for (const EnergyBalance::Work& of : run.simulation.built().dynamics().balance().works)
      work += of.value;
    EXPECT_GT(after.dissipated, 0.1 * work);
    EXPECT_LT(after.supplied, -0.01 * work);  // it leaves
    return (after.stored - before + after.dissipated - after.supplied - work) / work;
  };
  const double coarse = missing(4e-3), fine = missing(2e-3);
  EXPECT_LT(std::abs(fine), 0.002);
  EXPECT_NEAR(coarse / fine, 2, 0.5);
}

TEST(Consolidation, TheBalanceOfTheFluidCloses) {
  FieldRun run(column(20, 1e-2, 1e-7, 1e-7, loaded));
  run.run_to(0.5);
  const FieldBalance balance = run.balance();
  EXPECT_LT(balance.inflow, 0);  // it flows out
  EXPECT_NEAR(balance.content, balance.inflow + balance.produced, 1e-3 * std::abs(balance.inflow));
}

}  // namespace
}  // namespace suture::test
