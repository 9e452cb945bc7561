// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bodies that bend while their response changes: creep, relaxation, softening, thermal strains,
// damage, fibres. Cantilevers of 1 m x 0.1 m x 0.1 m with one and two elements of height.
#include <gtest/gtest.h>

#include <cmath>

#include "kernel/results/fields.hpp"
#include "tests/fields/field_scene.hpp"

namespace suture::test {
namespace {

std::string beam(int height, const std::string& model, const std::string& parameters,
                 const std::string& more) {
  const std::string n = std::to_string(height);
  return R"("mesh": {"box": {"size": [1, 0.1, 0.1], "cells": [)" + std::to_string(10 * height) +
         ", " + n + ", " + n + R"(]}}, "models": [{"model": ")" + model + R"(", "parameters": {)" +
         parameters + R"(}}], "constraints": [{"fix": "xyz", "where": {"set": "x0"}}], )" + more;
}
std::string tip_force(double newton) {
  return R"("loads": [{"force": [0, )" + std::to_string(newton) +
         R"(, 0], "where": {"set": "x1"}}])";
}
double tip(FieldRun& run) {
  Selection end;
  end.what = Selection::InBox{Vec3{1 - 1e-6, -1, -1}, Vec3{1 + 1e-6, 1, 1}};
  return run.simulation.mean_displacement(end)[1];
}
/// How far a ratio may be from the truth, by elements of height.
double tolerance(int height) { return height == 1 ? 0.1 : 0.03; }

class Bending : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Height, Bending, testing::Values(1, 2));

// ----------------------------------------------------------------- viscoelastic --

/// The series of plugins/visco for K = 861, n = 0.1138.
struct Series {
  double instant, modulus[5];
  Series() {
    const double n = 0.1138, ratio = std::pow(10, -n);
    double G = std::log(10) * 861 * std::pow(1e-3, -n) / (std::tgamma(1 - n) * std::tgamma(n));
    instant = G / (1 - ratio);
    for (double& m : modulus) m = G, G *= ratio;
  }
  /// The shear strain of the stress `instant`, applied at once, after `time`.
  double creep(double time, int steps) const {
    double strain = 1, flow[5] = {}, dt = time / steps;
    for (int i = 0; i < steps; ++i) {
      double stress = instant, stiffness = instant;
      for (int k = 0; k < 5; ++k) {
        const double h = dt / (1e-3 * std::pow(10, k)), left = std::exp(-h);
        const double mean = -std::expm1(-h) / h;
        flow[k] = flow[k] * left + strain * (mean - left);
        stress += modulus[k] * flow[k];
        stiffness -= modulus[k] * (1 - mean);
      }
      const double next = stress / stiffness;
      for (int k = 0; k < 5; ++k) {
        const double h = dt / (1e-3 * std::pow(10, k));
        flow[k] += next * (1 + std::expm1(-h) / h);
      }
      strain = next;
    }
    return strain;
  }
  /// The stress of a strain of 1, applied at once.
  double relaxed(double time) const {
    double stress = instant;
    for (int k = 0; k < 5; ++k) stress += modulus[k] * std::expm1(-time / (1e-3 * std::pow(10, k)));
    return stress / instant;
  }
};
const std::string visco = R"("K": 861, "n": 0.1138, "lambda": 1e6, "rho": 1e-6)";

TEST_P(Bending, ABeamCreepsAsItsMaterialDoes) {
  FieldRun run(field_scene(
      beam(GetParam(), "visco", visco,
           tip_force(-1e-4) + R"(, "solver": {"static": {"frames": 40}, "end": 100})")));
  FieldRun first(field_scene(
      beam(GetParam(), "visco", visco,
           tip_force(-1e-4) + R"(, "solver": {"static": {"frames": 1}, "end": 1e-7})")));
  const double expected = Series().creep(100, 20000);
  EXPECT_NEAR(expected, 3.706, 0.01);
  const double ratio = tip(run.run_to(100)) / tip(first.run_to(1e-7));
  EXPECT_NEAR(ratio / expected, 1, tolerance(GetParam()));
}

// --------------------------------------------------------------------- elastic --

TEST_P(Bending, AWarmBeamIsSofter) {
  const auto deflection = [&](const std::string& softening) {
    FieldRun run(
        field_scene(beam(GetParam(), "thermoelastic",
                         R"("mu": 4e4, "lambda": 6e4, "rho": 1000, "softening": )" + softening,
                         tip_force(-1e-4) + R"(, "fields": [{"field": "temperature", "start":
                                  303.15}], "solver": {"static": {}})")));
    return tip(run.run_to(1));
  };
  EXPECT_NEAR(deflection("0.23") / deflection("0") / std::exp(2.3), 1, tolerance(GetParam()));
}

// The curvature alpha dT / h bends the end by L^2 / 2 of it.
TEST_P(Bending, AGradientOfTemperatureBendsABeam) {
  for (const std::string lambda : {"6e4", "2e7"}) {
    FieldRun run(field_scene(beam(
        GetParam(), "thermoelastic",
        R"("mu": 4e4, "rho": 1000, "alpha": 1e-4, "lambda": )" + lambda,
        R"("fields": [{"field": "temperature", "start": 283.15, "where": {"set": "y0"}}, {"field":
             "temperature", "start": 303.15, "where": {"set": "y1"}}], "solver": {"static": {}})")));
    EXPECT_NEAR(tip(run.run_to(1)) / -0.01, 1, 0.1) << lambda;  // the clamp hinders 6 %
  }
}

// A bent beam whose fibres, along its axis, carry tension only: two moduli, a on one side and b on
// the other, bend as the modulus 4 a b / (sqrt(a) + sqrt(b))^2.
TEST_P(Bending, FibresAreTautOnOneSide) {
  const auto deflection = [&](const std::string& k1) {
    FieldRun run(field_scene(beam(GetParam(), "fibres",
                                  R"("mu": 1e4, "lambda": 0, "k2": 1, "rho": 1, "fibre": [1, 0, 0],
                                  "k1": )" +
                                      k1,
                                  tip_force(-1e-4) + R"(, "solver": {"static": {}})")));
    return tip(run.run_to(1));
  };
  // Along the fibres 2 mu and 2 mu + 4 k1: slack and taut.
  const double slack = 2e4, taut = 2e4 + 4 * 5e3;
  const double both = 4 * slack * taut / std::pow(std::sqrt(slack) + std::sqrt(taut), 2);
  EXPECT_NEAR(deflection("0") / deflection("5e3") / (both / slack), 1, tolerance(GetParam()));
}

// Mirrors and turns by right angles exchange the samples of an element.
TEST(BendingSamples, HaveNoHandedness) {
  const auto deflection = [](const std::string& size, const std::string& cells,
                             const std::string& force, const std::string& fibre, int axis) {
    FieldRun run(field_scene(
        R"("mesh": {"box": {"size": )" + size + R"(, "cells": )" + cells +
        R"(}}, "models": [{"model": "fibres", "parameters": {"mu": 1e4, "lambda": 1e4, "k1": 1e5,
        "k2": 1, "rho": 1, "fibre": )" +
        fibre + R"(}}], "constraints": [{"fix": "xyz", "where":
        {"set": ")" +
        "xyz"[(axis + 2) % 3] + R"(0"}}], "loads": [{"force": )" + force +
        R"(, "where": {"set": ")" + "xyz"[(axis + 2) % 3] + R"(1"}}], "solver": {"static": {}})"));
    run.run_to(1);
    Selection all;
    all.what = Selection::All{};
    return run.simulation.mean_displacement(all)[static_cast<std::size_t>(axis)];
  };
  const double u = deflection("[1, 0.2, 0.1]", "[5, 1, 1]", "[0, 0.05, 0]", "[0.8, 0.6, 0]", 1);
  EXPECT_GT(std::abs(u), 1e-3);
  EXPECT_NEAR(deflection("[0.1, 1, 0.2]", "[1, 5, 1]", "[0, 0, 0.05]", "[0, 0.8, 0.6]", 2), u,
              1e-7 * u);
  EXPECT_NEAR(deflection("[1, 0.2, 0.1]", "[5, 1, 1]", "[0, -0.05, 0]", "[0.8, -0.6, 0]", 1), -u,
              1e-7 * std::abs(u));
}

// ---------------------------------------------------------------------- linear --

TEST(LinearLaw, HasTheStressOfTheStrainOnEveryElement) {
  for (const std::string element : {"trilinear", "mean-gradient"}) {
    FieldRun run(field_scene(
        R"("mesh": {"box": {"size": [1, 1, 1], "cells": [1, 1, 1]}}, "models": [{"model": "hooke",
        "parameters": {"E": 1e5, "nu": 0.25, "rho": 1, "element": ")" +
        element +
        R"("}}], "constraints": [{"fix": "xyz", "where": {"set": "x0"}}, {"move": {"translation":
        [0.2, 0.1, 0]}, "ramp": 1, "where": {"set": "x1"}}], "solver": {"static": {}})"));
    run.run_to(1);
    std::vector<FrameField> fields;
    const FieldChoice choice = field_named(all_fields(run.simulation.built()), "stress", "");
    fill_fields({choice}, choice.on, {run.simulation.built(), {}, 0}, fields);
    // lambda = mu = 4e4; e_xx = 0.2, e_xy = 0.05
    const double expected[] = {2.4e4, 0.8e4, 0.8e4, 0.4e4, 0, 0};
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(fields.at(0).values[i], expected[i], 1e-9 * 2.4e4) << element << ' ' << i;
  }
}

}  // namespace
}  // namespace suture::test
