// SPDX-License-Identifier: GPL-3.0-or-later
//
// What static runs report is true: families of slender bodies, of events in the last frame, and of
// equilibria that are not unique.
//   SUTURE_FULL=1            all trials; otherwise a few of each family
//   SUTURE_STABILITY_SEED=N  others
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include "kernel/base/error.hpp"
#include "tests/run/unbalanced.hpp"
#include "tests/stability/trial.hpp"

namespace suture::test {
namespace {

PluginHost& plugins() {
  static PluginHost host;
  return host;
}

std::uint64_t seed() {
  const char* given = std::getenv("SUTURE_STABILITY_SEED");
  return given ? std::stoull(given) : 1;
}

/// trial(random, index) for all trials of a family, or the first ones.
template <class TrialOf>
void for_each_trial(const char* family, unsigned sample, unsigned all, TrialOf trial) {
  std::cout << family << ": seed " << seed() << '\n';
  for (unsigned i = 0; i < (std::getenv("SUTURE_FULL") ? all : sample); ++i) {
    SCOPED_TRACE(std::string(family) + " " + std::to_string(i));
    Random random(seed(), family, i);
    trial(random, i);
  }
}

struct FinishedRun {
  explicit FinishedRun(const Json& json)
      : simulation(scene_of(json.dump(), plugins()), plugins(), heard) {
    Observer nobody;
    summary = simulation.run(nobody);
  }
  std::string warnings() {
    std::string all;
    for (const std::string& text : heard.warnings()) all += text + '\n';
    return all;
  }
  Diagnostics heard;
  Simulation simulation;
  RunSummary summary;
};

Json beam(const Json& size, const Json& cells, const Json& model, const Json& solver) {
  return {{"suture", 1},
          {"mesh", {{"box", {{"size", size}, {"cells", cells}}}}},
          {"models", Json::array({model})},
          {"constraints", {{{"fix", "xyz"}, {"where", {{"set", "x0"}}}}}},
          {"solver", solver},
          {"output", false}};
}

// ------------------------------------------------------------------ slender bodies --

/// Under loads so small that the problem is linear, rounding of positions times the stiffness can
/// be far above the tolerance: the run ends there, says so, and the tip is where a larger load has
/// it, in proportion.
TEST(StaticTrials, SlenderBodiesEndAtTheirRounding) {
  unsigned limited = 0, count = 0;
  for_each_trial("slender", 4, 40, [&](Random& random, unsigned i) {
    const bool is_fine = i == 0;  // with which the defect was seen
    const double thickness = is_fine ? 0.02 : random.between(0.01, 0.04);
    const double young = random.decades(1e4, 1e8);
    const int across = is_fine ? 8 : i % 2 == 0 ? 2 : 4;
    const int along = is_fine ? 100 : random.pick(std::vector<int>{60, 100});
    const Json parameters = {{"E", young}, {"nu", 0.3}, {"rho", 1000}};
    Json scene =
        beam({1, thickness, thickness}, {along, across, across},
             {{"model", i % 3 == 1 ? "neo-hookean" : "tm-faure"}, {"parameters", parameters}},
             {{"static", Json::object()}, {"threads", 1}});
    Selection tip;
    tip.what = Selection::Named{"x1"};
    // sag = rho g A L^4 / (8 E I), I / A = t^2 / 12
    const auto with_sag = [&](double sag) {
      scene["gravity"] = {0, -sag * 8 * young * thickness * thickness / 12 / 1000, 0};
      return scene;
    };
    const double sag = is_fine ? 1e-3 : random.decades(1e-8, 1e-4), larger_sag = 1e-2;
    FinishedRun run(with_sag(sag)), larger(with_sag(larger_sag));
    EXPECT_EQ(run.summary.outcome, RunSummary::Outcome::finished);
    const double expected = larger.simulation.mean_displacement(tip)[1] * sag / larger_sag;
    EXPECT_GT(expected / -sag, 0.4) << "beam theory, less what such elements are too stiff";
    EXPECT_NEAR(run.simulation.mean_displacement(tip)[1] / expected, 1, 1e-2);
    const double left = unbalanced(run.simulation);
    ++count;
    limited += left > 1.1e-8;
    EXPECT_LT(left, 1e-2);
    EXPECT_EQ(run.warnings().find("the tolerance is below rounding error") != std::string::npos,
              left > 1e-8)
        << run.warnings();
  });
  EXPECT_GE(2 * limited, count) << "rounding was to matter";
}

// ------------------------------------------------------------ events in the last frame --

Json cut_at(double x, double depth) {
  const Json polygon = {{x, depth, -1}, {x, depth, 1}, {x, 1, 1}, {x, 1, -1}};
  return {{"plane", {{"polygon", polygon}}}};
}

Json event_at_end(Random& random, unsigned i) {
  const double x = random.between(0.2, 0.6);
  Json event;
  if (i % 4 == 3)
    event["pierce"] = {{"where", {{"box", {{"min", {x, 0.13, -1}}, {"max", {x + 0.25, 1, 1}}}}}}};
  else
    event["cut"] = cut_at(x, random.between(0.05, 0.15));
  if (i % 2 == 0)
    event["at"] = 1;
  else
    event["when"] = {{"where", {{"set", "x1"}}},
                     {"of", "displacement"},
                     {"component", "magnitude"},
                     {"above", i % 4 == 1 ? 0.001 : 0.01}};
  event["shape"] = "rest";
  return event;
}

/// What is in the last frame is an equilibrium of the body after the event: that of a run in which
/// the event comes before.
TEST(StaticTrials, EventsInTheLastFrameAreFollowedByAnEquilibrium) {
  for_each_trial("last frame", 4, 40, [](Random& random, unsigned i) {
    const Json parameters = {{"E", 4e5}, {"nu", 0.3}, {"rho", 1000}};
    Json scene =
        beam({1, 0.25, 0.25}, {8, 4, 2},
             {{"model", i % 3 == 0 ? "neo-hookean" : "tm-faure"}, {"parameters", parameters}},
             {{"static", {{"frames", 1 + i % 3}}}, {"end", 1}, {"threads", 1}});
    scene["gravity"] = {{"value", {0, -1.5, 0}}, {"ramp", 0.5}};
    scene["events"] = Json::array({event_at_end(random, i)});
    FinishedRun run(scene);
    ASSERT_GT(run.summary.faces_cut + run.summary.elements_removed, 0u);
    EXPECT_LT(unbalanced(run.simulation), 1.1e-8);

    Json before = scene;
    before["events"][0].erase("when");
    before["events"][0]["at"] = 0;
    FinishedRun same(before);
    Selection tip;
    tip.what = Selection::Named{"x1"};
    const Vec3 one = run.simulation.mean_displacement(tip),
               other = same.simulation.mean_displacement(tip);
    EXPECT_GT(std::abs(one[1]), 0.005);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(one[c], other[c], 1e-5 * std::abs(one[1]));
  });
}

// ----------------------------------------------------- equilibria that are not unique --

/// Whether "element 3 at (0.1, 0, 0.2) m" names an element of the box with a corner there.
bool names_a_corner(const std::string& text, double edge, const std::array<int, 3>& cells) {
  const std::size_t at = text.find("largest at element ");
  int number = 0;
  std::array<double, 3> place{};
  if (at == std::string::npos ||
      std::sscanf(text.c_str() + at, "largest at element %d at (%lf, %lf, %lf)", &number, &place[0],
                  &place[1], &place[2]) != 4)
    return false;
  bool is_corner = number < cells[0] * cells[1] * cells[2];
  for (std::size_t axis = 0; axis < 3; number /= cells[axis++]) {
    const double corner = place[axis] / edge - number % cells[axis];
    is_corner &= std::min(std::abs(corner), std::abs(corner - 1)) < 1e-3;
  }
  return is_corner;
}

/// A lattice of springs on three points, which hold it as a rigid body, has motions without
/// energy; a solid and springs that resist them have none.
TEST(StaticTrials, EquilibriaThatAreNotUniqueAreReported) {
  for_each_trial("not unique", 6, 24, [](Random& random, unsigned i) {
    const double edge = random.decades(0.01, 1), slack = edge / 10;
    const std::array<int, 3> cells{2 + static_cast<int>(i % 3), 2, 2 + static_cast<int>(i % 2)};
    const std::array<double, 3> size{edge * cells[0], edge * cells[1], edge * cells[2]};
    const bool is_lattice = i % 2 == 0, searches = i % 4 < 2;
    const Json parameters = {{"E", random.decades(1e3, 1e7)}, {"nu", 0.25}, {"rho", 1000}};
    const std::string model = is_lattice ? "mss-baudet" : i % 3 == 0 ? "tm-faure" : "mss-golec";
    const auto hold = [&](double x, double y, const char* components) -> Json {
      const Json box = {{"min", {x - slack, y - slack, -slack}},
                        {"max", {x + slack, y + slack, slack}}};
      return {{"fix", components}, {"where", {{"box", box}}}};
    };
    Json solver = {{"static", Json::object()}, {"threads", 1}};
    if (searches) solver = {{"until", "rest"}, {"threads", 1}};
    Json scene = beam(size, cells, {{"model", model}, {"parameters", parameters}}, solver);
    scene["constraints"] = {hold(0, 0, "xyz"), hold(size[0], 0, "yz"), hold(0, size[1], "z")};
    FinishedRun run(scene);
    EXPECT_EQ(run.warnings().find("the equilibrium is not unique") != std::string::npos, is_lattice)
        << run.warnings();
    if (is_lattice) {
      EXPECT_TRUE(names_a_corner(run.warnings(), edge, cells)) << run.warnings();
    }
  });
}

}  // namespace
}  // namespace suture::test
