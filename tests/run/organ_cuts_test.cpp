// SPDX-License-Identifier: GPL-3.0-or-later
//
// Organs of cubes, held on one side, pulled on the other and cut at random, all with default
// settings, run to their end.
//   SUTURE_FULL=1          40 cuts; otherwise a sample of 4
//   SUTURE_ORGAN_SEED=N    other cuts
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <random>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "tests/base/sanitizer.hpp"
#include "tests/run/beam.hpp"
#include "tests/run/host.hpp"
#include "tests/run/test_simulation.hpp"

namespace suture::test {
namespace {

struct Ball {
  Vec3 centre, half_axes;
};
/// The union of balls; lengths in m.
using Organ = std::vector<Ball>;

const std::map<std::string, Organ>& organs() {
  static const std::map<std::string, Organ> all{
      {"liver",
       {{{-0.03, 0, 0}, {0.06, 0.045, 0.04}},
        {{0.03, 0.012, 0.005}, {0.06, 0.026, 0.03}},
        {{0.07, 0.016, 0.01}, {0.04, 0.014, 0.02}}}},
      {"kitten",
       {{{0, 0, 0}, {0.06, 0.03, 0.03}},
        {{0.07, 0.03, 0}, {0.026, 0.024, 0.024}},
        {{0.075, 0.056, 0.014}, {0.007, 0.012, 0.007}},
        {{0.075, 0.056, -0.014}, {0.007, 0.012, 0.007}},
        {{0.035, -0.035, 0.015}, {0.012, 0.03, 0.01}},
        {{0.035, -0.035, -0.015}, {0.012, 0.03, 0.01}},
        {{-0.035, -0.035, 0}, {0.015, 0.03, 0.02}},
        {{-0.075, 0.012, 0}, {0.035, 0.01, 0.01}}}},
      {"giraffe",
       {{{0, 0, 0}, {0.05, 0.026, 0.02}},
        {{0.052, 0.035, 0}, {0.014, 0.05, 0.012}},
        {{0.07, 0.078, 0}, {0.03, 0.012, 0.012}},
        {{0.03, -0.04, 0.011}, {0.009, 0.045, 0.009}},
        {{0.03, -0.04, -0.011}, {0.009, 0.045, 0.009}},
        {{-0.03, -0.04, 0}, {0.009, 0.045, 0.017}}}},
  };
  return all;
}

bool contains(const Organ& organ, const Vec3& p) {
  return std::ranges::any_of(organ, [&](const Ball& ball) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c)
      sum += std::pow((p[c] - ball.centre[c]) / ball.half_axes[c], 2);
    return sum < 1;
  });
}

/// The cubes of a grid whose centres lie inside.
std::shared_ptr<const Mesh> filled(const Organ& organ, double edge) {
  auto mesh = std::make_shared<Mesh>();
  mesh->source = "an organ";
  std::map<std::array<int, 3>, Index> points;
  constexpr int reach = 20;
  for (int k = -reach; k < reach; ++k)
    for (int j = -reach; j < reach; ++j)
      for (int i = -reach; i < reach; ++i) {
        if (!contains(organ, {(i + 0.5) * edge, (j + 0.5) * edge, (k + 0.5) * edge})) continue;
        Hexahedron nodes;
        for (int n = 0; n < 8; ++n) {
          const std::array<int, 3> at{i + (n & 1), j + (n >> 1 & 1), k + (n >> 2 & 1)};
          const auto [point, is_new] =
              points.try_emplace(at, static_cast<Index>(mesh->points.size()));
          if (is_new) mesh->points.push_back({at[0] * edge, at[1] * edge, at[2] * edge});
          nodes[static_cast<std::size_t>(n)] = point->second;
        }
        mesh->hexahedra.push_back(nodes);
      }
  return mesh;
}

/// The same numbers on every machine.
class Numbers {
 public:
  explicit Numbers(unsigned seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }

 private:
  std::mt19937 engine_;
};

struct Extent {
  explicit Extent(const Mesh& mesh) {
    for (const Vec3& p : mesh.points)
      for (std::size_t c = 0; c < 3; ++c) {
        low[c] = std::min(low[c], p[c]);
        high[c] = std::max(high[c], p[c]);
      }
  }
  double at(std::size_t c, double part) const { return low[c] + part * (high[c] - low[c]); }
  double length(std::size_t c) const { return high[c] - low[c]; }
  Vec3 low{1, 1, 1}, high{-1, -1, -1};
};

Selection beyond(std::size_t axis, double place, double side) {
  Selection::HalfSpace half{};
  half.point[axis] = place;
  half.normal[axis] = side;
  Selection selection;
  selection.what = half;
  return selection;
}

Event plane(const Extent& extent, Numbers& random, double at) {
  CutPlane cut;
  for (std::size_t c = 0; c < 3; ++c) {
    cut.point[c] = extent.at(c, random.between(0.35, 0.65));
    cut.normal[c] = random.between(-0.6, 0.6);
  }
  cut.normal[0] = 1;
  cut.radius = random.between(0.3, 0.6) * extent.length(1);
  Event event;
  event.at = at;
  event.what = cut;
  return event;
}

/// From one side to the other, straight or along an arc.
Event blade(const Extent& extent, Numbers& random, bool is_arc) {
  const int stations = is_arc ? 6 : 2;
  const double depth = random.between(0.3, 0.7), middle = random.between(0.35, 0.65),
               slant = random.between(-0.15, 0.15), bow = is_arc ? random.between(-0.2, 0.2) : 0;
  CutBlade cut;
  for (int i = 0; i < stations; ++i) {
    const double u = static_cast<double>(i) / (stations - 1);
    const double x = extent.at(0, middle + slant * (2 * u - 1) + 4 * bow * u * (1 - u));
    const double z = extent.at(2, 1.2 * u - 0.1), lean = random.between(-0.05, 0.05);
    cut.stations.push_back(
        {0.15 + 0.2 * u,
         {{x, extent.at(1, 1.3), z}, {x + lean * extent.length(0), extent.at(1, depth), z}}});
  }
  Event event;
  event.what = cut;
  return event;
}

Scene organ_cut(const Organ& organ, unsigned number, unsigned seed) {
  Numbers random(1000 * seed + number);
  Scene scene = beam(host(), "neo-hookean", 1, 1, 0, {{"E", 1e4}, {"nu", 0.45}, {"rho", 1060}});
  scene.mesh.box.reset();
  scene.mesh.given = filled(organ, 0.0065);
  const Extent extent(*scene.mesh.given);
  scene.gravity = {0, number % 2 == 0 ? -9.81 : 9.81, 0};
  scene.gravity_ramp.to = 0.1;
  scene.constraints[0].where = beyond(0, extent.at(0, 0.15), -1);
  Constraint pull;
  pull.where = beyond(0, extent.at(0, 0.88), 1);
  pull.moves = true;
  for (std::size_t c = 0; c < 3; ++c)
    pull.translation[c] = random.between(-0.08, 0.08) * extent.length(0);
  pull.translation[0] = random.between(0.02, 0.12) * extent.length(0);
  pull.ramp = {0.02, 0.15};
  scene.constraints.push_back(pull);
  scene.contact.pieces = true;
  scene.solver.damping = random.between(0, 5);
  scene.solver.end = 0.4;
  if (number % 3 == 0)
    scene.events = {plane(extent, random, 0.16), plane(extent, random, 0.22)};
  else
    scene.events = {blade(extent, random, number % 3 == 1)};
  return scene;
}

unsigned seed() {
  const char* given = std::getenv("SUTURE_ORGAN_SEED");
  return given ? static_cast<unsigned>(std::atoi(given)) : 1;
}

/// How many inverted, of which a few were borne.
Index run_cut(const std::string& name, unsigned number) {
  SCOPED_TRACE(name + ", cut " + std::to_string(number) + ", seed " + std::to_string(seed()));
  TestSimulation simulation(organ_cut(organs().at(name), number, seed()));
  Observer observer;
  try {
    const RunSummary summary = simulation.run(observer);
    EXPECT_EQ(summary.outcome, RunSummary::Outcome::finished);
    EXPECT_NEAR(summary.time, 0.4, 1e-12);
    EXPECT_LT(std::abs(summary.balance), 0.02 * summary.exchanged);
    const auto says = [](const std::string& text) {
      return text.find("inverted") != std::string::npos;
    };
    EXPECT_EQ(std::ranges::count_if(simulation.diagnostics.warnings(), says),
              summary.inverted_elements > 0);
    return static_cast<Index>(summary.inverted_elements);
  } catch (const Error& error) {
    ADD_FAILURE() << error.what();
  }
  return 0;
}

TEST(OrganCuts, RunToTheirEnd) {
  const bool full = std::getenv("SUTURE_FULL") != nullptr && sanitizer.empty();
  const std::vector<std::string> names{"liver", "kitten", "giraffe"};
  unsigned with_inversion = 0;
  for (unsigned number = 0; number < 40; number += full ? 1 : 10)
    with_inversion += run_cut(names[number / 2 % 3], number) > 0;
  std::cout << with_inversion << " with inverted elements\n";
  EXPECT_GT(with_inversion, 0u) << "of the cuts, none shows what it is to show";
}

}  // namespace
}  // namespace suture::test
