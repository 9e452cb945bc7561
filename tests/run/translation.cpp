// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/run/translation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <regex>

#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

/// Messages without the places in them, "(1, 2, 3) m", which are those of the scene.
std::vector<std::string> without_places(std::vector<std::string> lines) {
  static const std::regex place("\\([^()]*\\) m");
  for (std::string& line : lines) line = std::regex_replace(line, place, "(place)");
  return lines;
}

}  // namespace

std::string at(const Vec3& point, const Vec3& shift) {
  char text[120];
  std::snprintf(text, sizeof text, "[%.17g, %.17g, %.17g]", point[0] + shift[0],
                point[1] + shift[1], point[2] + shift[2]);
  return text;
}

TranslatedRun::TranslatedRun(const Scene& scene) {
  TestSimulation simulation(scene);
  MessageList heard;
  summary = simulation.run(heard);
  events = heard.lines;
  warnings = simulation.diagnostics.warnings();
  Attributes& a = simulation.attributes();
  for (Index v = 0; v < a.vertex_count(); ++v) {
    if (!simulation.complex().exists(0, v)) continue;
    for (int c = 0; c < 3; ++c) {
      displacement.push_back(a.position().get(v, c) - a.rest().get(v, c));
      velocity.push_back(a.velocity().get(v, c));
      largest = std::max(largest, std::abs(displacement.back()));
    }
  }
  energies = simulation.energies();
}

void expect_same(const TranslatedRun& near, const TranslatedRun& far, double tolerance) {
  EXPECT_EQ(near.summary.steps, far.summary.steps);
  EXPECT_EQ(near.summary.outcome, far.summary.outcome);
  EXPECT_EQ(near.summary.faces_cut, far.summary.faces_cut);
  EXPECT_EQ(near.summary.faces_torn, far.summary.faces_torn);
  EXPECT_EQ(near.summary.faces_sewn, far.summary.faces_sewn);
  EXPECT_EQ(near.summary.elements_removed, far.summary.elements_removed);
  EXPECT_EQ(without_places(near.events), without_places(far.events));
  EXPECT_EQ(near.warnings, far.warnings);
  EXPECT_GT(near.largest, 1e-3) << "something must have moved";
  ASSERT_EQ(near.displacement.size(), far.displacement.size());
  double difference = 0;
  for (std::size_t i = 0; i < near.displacement.size(); ++i)
    difference = std::max(difference, std::abs(near.displacement[i] - far.displacement[i]));
  EXPECT_LE(difference, tolerance * near.largest);
  EXPECT_NEAR(near.energies.kinetic, far.energies.kinetic, tolerance * near.energies.kinetic);
  EXPECT_NEAR(near.energies.elastic, far.energies.elastic, tolerance * near.energies.elastic);
  if (tolerance == 0) {
    EXPECT_TRUE(near.velocity == far.velocity);
  }
}

void expect_near(double a, double b, double tolerance, const std::string& what) {
  EXPECT_EQ(std::isnan(a), std::isnan(b)) << what;
  if (!std::isnan(a)) {
    EXPECT_NEAR(a, b, tolerance) << what;
  }
}

}  // namespace suture::test
