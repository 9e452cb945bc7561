// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cracks of a phase field.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "tests/fields/field_scene.hpp"

namespace suture::test {
namespace {

// Poisson's ratio is 0, so the ends of the bar may be clamped.
constexpr double young = 12e9, toughness = 1e4, length = 0.1, area = 0.01;
const double strength = std::sqrt(3 * toughness * young / (8 * length));

/// A bar of 1 m with n elements along x, pulled until `ramp` to twice the strain at its strength;
/// its middle is a little weaker.
Scene pulled_bar(int n, double viscosity, double ramp, const std::string& solver,
                 const std::string& more = R"("title": "")") {
  std::ostringstream text;
  text << R"("mesh": {"box": {"size": [1, 0.1, 0.1], "cells": [)" << n << R"(, 1, 1]}}, "models":
      [{"model": "gradient-damage", "parameters": {"mu": 6e9, "K": 4e9, "rho": 1000, "Gc": 1e4,
      "l": 0.1, "eta": )"
       << viscosity << R"(}}], "constraints": [{"fix": "xyz", "where": {"set": "x0"}}, {"move":
      {"translation": [)"
       << 2 * strength / young << R"(, 0, 0]}, "ramp": )" << ramp << R"(, "where": {"set": "x1"}}],
      "fields": [{"field": "damage", "start": 0.01, "where": {"box": {"min": [0.49, -1, -1], "max":
      [0.51, 1, 1]}}}], "solver": )"
       << solver << ", " << more;
  return field_scene(text.str());
}

/// Force over area at the end x = 1.
double stress(FieldRun& run) {
  std::vector<Index> end;
  for (Index v = 0; v < run.simulation.attributes().vertex_count(); ++v)
    if (run.simulation.attributes().rest().get(v, 0) > 1 - 1e-9) end.push_back(v);
  double sum = 0;
  for (const Vec3& force : run.simulation.built().body().forces_at(end, run.simulation.time()))
    sum -= force[0];
  return sum / area;
}

/// Its largest value until it has fallen to a half of it.
double largest_stress(FieldRun& run, int steps) {
  double largest = 0;
  for (int i = 1; i <= steps; ++i) {
    const double now = stress(run.run_to(static_cast<double>(i) / steps));
    largest = std::max(largest, now);
    if (now < largest / 2) return largest;
  }
  ADD_FAILURE() << "the bar did not break";
  return largest;
}

TEST(Cracks, TheStrengthOfABarIsThatOfTheClosedFormOnAnyMesh) {
  for (const int n : {20, 40}) {
    FieldRun run(pulled_bar(n, 0, 1, R"({"static": {"frames": 200}})"));
    const double relative = largest_stress(run, 200) / strength;
    EXPECT_NEAR(relative, 1, 0.03) << n;
    RecordProperty("strength with " + std::to_string(n) + " elements", std::to_string(relative));
    EXPECT_GT(run.at(0.5), 0.95);
    EXPECT_LT(run.at(0.9), 0.1);
  }
}

TEST(Cracks, CostTheirToughnessAndFadeAsAParabola) {
  // d = (1 - |x| / 2 l)^2 on both sides of a crack, whose energy is Gc per area.
  FieldRun run(
      field_scene(R"("mesh": {"box": {"size": [1, 0.1, 0.1], "cells": [40, 1, 1]}}, "models":
      [{"model": "gradient-damage", "parameters": {"mu": 6e9, "K": 4e9, "rho": 1000, "Gc": 1e4,
      "l": 0.1}}], "constraints": [{"fix": "xyz", "where": "all"}], "fields": [{"field": "damage",
      "start": 1, "where": {"box": {"min": [0.49, -1, -1], "max": [0.51, 1, 1]}}}], "solver":
      {"static": {"frames": 1}})"));
  run.run_to(1);
  EXPECT_NEAR(run.energy().stored / (toughness * area), 1, 0.01);
  EXPECT_EQ(run.equation().balance_text(1).find("damage: no capacity"), 0u);
  EXPECT_LT(run.error([](double x) {
    const double rest = std::max(0.0, 1 - std::abs(x - 0.5) / (2 * length));
    return rest * rest;
  }),
            0.01);
}

TEST(Cracks, BecomeACut) {
  FieldRun run(pulled_bar(20, 0, 1, R"({"static": {"frames": 50}})",
                          R"("events": [{"every": 1, "tear": {"by": {"model": "gradient-damage",
      "field": "damage"}, "above": 0.9, "most": 1}}])"));
  run.run_to(1);
  EXPECT_EQ(run.simulation.built().body().islands().existing(), 2u);
  EXPECT_EQ(run.simulation.attributes().vertex_count(), 21u * 4 + 4);
  EXPECT_LT(std::abs(stress(run)), 1e-3 * strength);
}

TEST(Cracks, StayOpenBeyondADamageOfOne) {
  const auto stress_at = [](double damage) {
    Scene scene =
        field_scene(R"("mesh": {"box": {"size": [1, 0.1, 0.1], "cells": [2, 1, 1]}}, "models":
        [{"model": "gradient-damage", "parameters": {"mu": 6e9, "K": 4e9, "rho": 1000, "Gc": 1e4,
        "l": 0.1, "r": 1e-3}}], "constraints": [{"fix": "xyz", "where": {"set": "x0"}}, {"move":
        {"translation": [1e-3, 0, 0]}, "ramp": 1, "where": {"set": "x1"}}], "fields": [{"field":
        "damage", "where": "all", "fix": 1}], "solver": {"static": {"frames": 1}})");
    scene.fields.front().path.stations = {{0, damage}};  // beyond what a scene may say
    FieldRun run(scene);
    return stress(run.run_to(1));
  };
  EXPECT_NEAR(stress_at(1) / (1e-3 * 1e-3 * young), 1, 0.01);
  EXPECT_NEAR(stress_at(1.5) / stress_at(1), 1, 1e-6);
}

TEST(Cracks, TearingByAModelReadsItsOwnField) {
  // The springs of one half break long before the other half has any damage.
  FieldRun run(
      field_scene(R"("mesh": {"box": {"size": [1, 0.1, 0.1], "cells": [10, 1, 1]}}, "models": [
      {"model": "tm-faure", "region": {"half_space": {"point": [0.5, 0, 0], "normal": [-1, 0, 0]}},
       "parameters": {"E": 1e5, "nu": 0, "rho": 1000}},
      {"model": "damage-springs", "region": {"half_space": {"point": [0.5, 0, 0], "normal":
       [-1, 0, 0]}}, "adds": true, "parameters": {"E": 1e5, "rho": 1, "e0": 0.01, "e1": 0.1}},
      {"model": "gradient-damage", "region": {"half_space": {"point": [0.5, 0, 0], "normal":
       [1, 0, 0]}}, "parameters": {"mu": 6e9, "K": 4e9, "rho": 1000, "Gc": 1e4, "l": 0.1}}],
      "constraints": [{"fix": "xyz", "where": {"set": "x0"}}, {"move": {"translation": [0.3, 0, 0]},
      "ramp": 1, "where": {"set": "x1"}}], "events": [{"every": 1, "tear": {"by": {"model":
      "damage-springs", "field": "damage"}, "above": 0.05, "most": 1}}], "solver": {"static":
      {"frames": 20, "free_pieces": "hold"}})"));
  run.run_to(0.5);
  EXPECT_GT(run.simulation.built().body().islands().existing(), 1u);
  EXPECT_LT(std::ranges::max(run.values()), 0.05);
}

TEST(Cracks, TheEnergyOfMotionAndDamageIsInTheBooks) {
  FieldRun run(
      pulled_bar(20, 10, 0.01, R"({"integrator": "symplectic-euler", "dt": 2.5e-6, "end": 0.01})"));
  run.run_to(0.01);
  EXPECT_GT(std::ranges::max(run.values()), 0.9);  // waves choose the place
  const EnergyBalance motion = run.simulation.built().dynamics().balance();
  const FieldEnergy damage = run.energy();
  EXPECT_GT(damage.dissipated, 0);
  const double all = motion.kinetic + damage.stored + damage.dissipated;
  EXPECT_NEAR(all / motion.prescribed, 1, 0.02);
  RecordProperty("energy over work", std::to_string(all / motion.prescribed));
  EXPECT_NEAR(-motion.models / (damage.stored + damage.dissipated), 1, 0.02);
}

TEST(Cracks, DoNotHeal) {
  const Scene scene = pulled_bar(20, 10, 0.01, R"({"integrator": "implicit-euler", "dt": 1e-4,
      "end": 0.02})");
  FieldRun run(scene);
  std::vector<double> before = run.run_to(0.002).values();
  for (const double t : {0.004, 0.006, 0.01}) {
    const std::vector<double> now = run.run_to(t).values();
    for (std::size_t v = 0; v < now.size(); ++v) EXPECT_GE(now[v], before[v]);
    before = now;
  }
  EXPECT_GT(run.at(0.5), 0.9);
}

}  // namespace
}  // namespace suture::test
