// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scenes with contact from jittered starts: nothing enters anything, no energy from nowhere, and
// what touched goes on touching.
//   SUTURE_FULL=1  ten starts of each scene; otherwise one
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "kernel/base/error.hpp"
#include "kernel/build/built_scene.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/run/simulation.hpp"
#include "tests/contact/robust/robust_scenes.hpp"
#include "tests/contact/robust/separation.hpp"

namespace suture::test::robust_test {
namespace {

// Depths of nodes, and of middles of edges; in elements.
constexpr double most_of_nodes = 0.1, most_of_edges = 0.25;
constexpr double most_growth = 0.15;  // of the energy that was exchanged
constexpr double rounding = 1e-6;     // J
constexpr int checks = 40;            // of a run

PluginHost& plugins() {
  static PluginHost host;
  return host;
}

/// "" if all is well.
std::string wrong_energy(Simulation& simulation) {
  const EnergyBalance books = simulation.built().dynamics().balance();
  double tools = 0;
  for (const Obstacle& obstacle : simulation.contact()->obstacles())
    if (obstacle.motion.moves()) tools = 1;
  const double growth = std::max(books.balance - books.recoverable, 0.0) + books.work("friction") +
                        (1 - tools) * books.work("contact");
  if (!std::isfinite(books.kinetic + books.elastic)) return "energies are not finite";
  if (growth <= most_growth * books.exchanged + rounding) return "";
  return "energy grew by " + std::to_string(100 * growth / books.exchanged) +
         " % of what was exchanged";
}

std::string run(const RobustCase& of, unsigned seed) {
  std::mt19937 random(seed);
  const RobustScene made = of.make(plugins(), random);
  Diagnostics diagnostics;
  Simulation simulation(made.scene, plugins(), diagnostics);
  if (made.start) made.start(simulation);
  Observer nobody;
  bool touched = false;
  double deepest = 0;
  for (int check = 1; check <= checks; ++check) {
    const double time = *made.scene.solver.end * check / checks;
    try {
      simulation.run_to(time, nobody);
    } catch (const Error& error) {
      return error.what();
    }
    touched |= !simulation.contact()->touches().empty();
    const Intrusion found =
        deepest_intrusion(simulation.complex(), simulation.attributes(),
                          simulation.contact()->obstacles(), simulation.time(), robust_edge);
    deepest = std::max(deepest, found.depth / robust_edge);
    const double most = found.is_on_edge ? most_of_edges : most_of_nodes;
    if (found.depth > most * robust_edge)
      return "t = " + std::to_string(time) + " s: " + (found.is_on_edge ? "an edge" : "a node") +
             " is " + std::to_string(found.depth / robust_edge) + " of an element inside " +
             found.into + " at " + std::to_string(found.place[0]) + ", " +
             std::to_string(found.place[1]) + ", " + std::to_string(found.place[2]);
    if (const std::string text = wrong_energy(simulation); !text.empty())
      return "t = " + std::to_string(time) + " s: " + text;
  }
  ::testing::Test::RecordProperty("deepest", std::to_string(deepest));
  return touched ? "" : "nothing touched";
}

class RobustContact : public ::testing::TestWithParam<std::size_t> {};

TEST_P(RobustContact, KeepsSurfacesApart) {
  const RobustCase& of = robust_cases()[GetParam()];
  const unsigned seeds = std::getenv("SUTURE_FULL") ? 10 : 1;
  for (unsigned seed = 1; seed <= seeds; ++seed)
    EXPECT_EQ(run(of, seed), "") << of.name << ", seed " << seed;
}

std::string name_of(const ::testing::TestParamInfo<std::size_t>& info) {
  std::string name = robust_cases()[info.param].name;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Scenes, RobustContact,
                         ::testing::Range<std::size_t>(0, robust_cases().size()), name_of);

/// Loose pieces are damped as "auto" does, which changes the step's gain all the time.
TEST(Rest, IsFoundForPilesAndWedges) {
  const unsigned seeds = std::getenv("SUTURE_FULL") ? 10 : 1;
  unsigned searches = 0, found = 0;
  for (const RobustCase& of : robust_cases()) {
    if (!of.comes_to_rest) continue;
    for (unsigned seed = 1; seed <= seeds; ++seed, ++searches) {
      std::mt19937 random(seed);
      RobustScene made = of.make(plugins(), random);
      made.scene.solver.end.reset();
      made.scene.solver.until_rest = made.scene.solver.automatic_damping = true;
      made.scene.solver.tolerance = 1e-4;
      Diagnostics diagnostics;
      Simulation simulation(made.scene, plugins(), diagnostics);
      Observer nobody;
      try {
        simulation.run(nobody);
        ++found;
      } catch (const Error& error) {
        std::cout << of.name << ", seed " << seed << ": " << error.what() << "\n";
      }
    }
  }
  EXPECT_GE(found, (9 * searches + 9) / 10) << "of " << searches;
}

/// The check itself.
TEST(Separation, IsMeasuredWithoutTheCodeOfContact) {
  std::mt19937 random(1);
  RobustScene made = robust_cases()[1].make(plugins(), random);
  Diagnostics diagnostics;
  Simulation simulation(made.scene, plugins(), diagnostics);
  const auto deepest = [&] {
    return deepest_intrusion(simulation.complex(), simulation.attributes(),
                             simulation.contact()->obstacles(), 0, robust_edge)
        .depth;
  };
  EXPECT_EQ(deepest(), 0);
  Attributes& a = simulation.attributes();
  const auto lift = [&](double low, double by) {
    for (Index v = 0; v < a.vertex_count(); ++v)
      if (a.rest().get(v, 2) + simulation.origin()[2] > low)
        a.position().set(v, 2, a.position().get(v, 2) + by);
  };
  lift(0.65, -0.035);
  EXPECT_NEAR(deepest(), 0.02, 1e-9);
  lift(0.65, 0.035);
  lift(-1, -0.04);
  EXPECT_NEAR(deepest(), 0.03, 1e-9) << "in the floor";
}

}  // namespace
}  // namespace suture::test::robust_test
