// SPDX-License-Identifier: GPL-3.0-or-later
//
// Laws that read a field.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/fields/field_scene.hpp"

namespace suture::test {
namespace {

/// A cube of 0.1 m of the law, with supports that leave it free to grow.
Scene cube(const std::string& element, double kelvin, const std::string& more) {
  return field_scene(
      R"("mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [2, 2, 2]}}, "models": [{"model":
      "thermoelastic", "parameters": {"mu": 1e4, "lambda": 2e4, "rho": 1000, "alpha": 1e-3,
      "softening": 5e-3, "element": ")" +
      element + R"("}}], "constraints": [{"fix": "x", "where": {"set": "x0"}}, {"fix": "y", "where":
      {"set": "y0"}}, {"fix": "z", "where": {"set": "z0"}}], "fields": [{"field": "temperature",
      "fix": )" +
      std::to_string(293.15 + kelvin) +
      R"(, "where": "all"}], "solver": {"static": {"frames": 1}}, )" + more);
}

class Laws : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Elements, Laws, testing::Values("trilinear", "mean-gradient"));

TEST_P(Laws, AFreeCubeExpandsWithTemperature) {
  FieldRun run(cube(GetParam(), 20, R"("title": "")"));
  run.run_to(1);
  const Attributes& attributes = run.simulation.attributes();
  for (Index v = 0; v < attributes.vertex_count(); ++v)
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(run.simulation.attributes().position().get(v, c),
                  std::exp(0.02) * run.simulation.attributes().rest().get(v, c), 1e-9);
}

TEST_P(Laws, AWarmCubeIsSofter) {
  // Small loads: the strain beyond the expansion is that of the cold cube over exp(-0.005 dT).
  const auto strain = [&](double kelvin, double stretch) {
    FieldRun run(cube(GetParam(), kelvin, R"("loads": [{"traction": [1, 0, 0], "ramp": 1, "where":
        {"set": "x1"}}])"));
    run.run_to(1);
    Selection end;
    end.what = Selection::Nearest{Vec3{0.1, 0.1, 0.1}};
    return run.simulation.mean_displacement(end)[0] / 0.1 - (stretch - 1);
  };
  EXPECT_NEAR(strain(0, 1) / strain(40, std::exp(0.04)), std::exp(-0.2 + 0.04), 1e-3);
}

TEST(Coupled, TheWorkOfAHeatedSolidIsInTheLedger) {
  Scene scene = field_scene(
      R"("mesh": {"box": {"size": [0.1, 0.05, 0.05], "cells": [4, 2, 2]}}, "models": [{"model": "heat",
      "parameters": {"k": 0.5, "c": 20}}, {"model": "thermoelastic", "parameters": {"mu": 1e4,
      "lambda": 2e4, "rho": 1000, "alpha": 1e-3, "softening": 2e-3}}], "constraints": [{"fix": "xyz",
      "where": {"set": "x0"}}], "fields": [{"field": "temperature", "move": [[0, 293.15], [0.02, 340]],
      "where": {"set": "y1"}}], "solver": {"integrator": "symplectic-euler", "dt": 1e-4, "end": 0.1})");
  FieldRun run(scene);
  run.run_to(0.05);
  const EnergyBalance balance = run.simulation.built().dynamics().balance();
  EXPECT_GT(std::abs(balance.models), 0);
  EXPECT_LT(std::abs(balance.balance), 0.02 * (std::abs(balance.models) + balance.kinetic));
}

// rate-half-loss says half of what its flow dissipates.
TEST(Coupled, WhatALawDissipatesClosesTheBooksOfEveryScheme) {
  static const bool is_loaded = (plugins().add_file(TEST_PLUGINS "/faulty-rates.so"), true);
  EXPECT_TRUE(is_loaded);
  for (const std::string integrator : {"symplectic-euler", "implicit-euler"}) {
    FieldRun run(field_scene(
        R"("mesh": {"box": {"size": [1, 1, 1], "cells": [8, 2, 2]}}, "models": [{"model":
        "rate-half-loss"}], "constraints": [{"fix": "xyz", "where": "all"}], "fields": [{"field":
        "u", "start": 1, "where": {"set": "x0"}}, {"field": "u", "fix": 1, "where": {"set": "x0"}},
        {"field": "u", "flux": 0.5, "where": {"set": "x1"}}], "solver": {"integrator": ")" +
        integrator + R"(", "dt": 1e-4, "end": 0.1})"));
    const double before = run.energy().stored;
    run.run_to(0.05);
    const FieldEnergy now = run.energy();
    EXPECT_GT(now.supplied, 0.1);
    EXPECT_NEAR(now.stored + 2 * now.dissipated, before + now.supplied, 0.01 * now.supplied)
        << integrator;
  }
}

}  // namespace
}  // namespace suture::test
