// SPDX-License-Identifier: GPL-3.0-or-later
//
// Equilibria of a body whose stiffness jumps: a soft block with stiff balls at random places.
//
// Beside the figures of D. Davydov et al., A matrix-free approach for finite-strain hyperelastic
// problems using geometric multigrid, Int. J. Numer. Meth. Engng. 121 (2020), 2874-2895: matrix,
// load, load steps and tolerances are theirs. Their block has one hole and two inclusions that its
// mesh follows; here a regular grid cuts through 60.
#include <random>

#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/machine.hpp"
#include "apps/suture-bench/timer.hpp"
#include "apps/suture-bench/work_scene.hpp"
#include "kernel/run/simulation.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture::bench {
namespace {

using Json = nlohmann::json;

struct InclusionOptions {
  std::vector<Index> across{32, 54}, jumps{1, 100, 10000};
  unsigned seed = 1;
};

constexpr double young = 2 * 1.3 * 0.4225e6;  // of the matrix, Pa; nu 0.3
constexpr double traction = 12.5e3;           // along x and y, Pa
constexpr int load_steps = 5, balls = 60;
// CPU time of 20 cores per unknown, trilinear elements, 4.44 M unknowns, a jump of 100.
constexpr double published_us = 833, published_iterations = 25;

/// Balls in the unit cube, which may overlap and take an eighth of it, as regions of a table.
Json random_balls(double modulus, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0, 1), radius(0.05, 0.11);
  Json regions = Json::array();
  for (int i = 0; i < balls; ++i) {
    const Vec3 centre{place(random), place(random), place(random)};
    regions.push_back({{"region", {{"sphere", {{"centre", centre}, {"radius", radius(random)}}}}},
                       {"value", modulus}});
  }
  return regions;
}

/// A cube of n^3 elements, fixed below, and pushed aside above.
Scene block(PluginHost& host, Index n, double jump, unsigned seed, Diagnostics& diagnostics) {
  Json scene = box_scene({{n, n, n}}, {1, 1, 1}, static_method("neo-hookean", "trilinear"),
                         {{"nu", 0.3}, {"rho", 1000}});
  scene["models"][0]["parameters"]["E"] = {{"regions", random_balls(jump * young, seed)},
                                           {"elsewhere", young}};
  scene["constraints"] = {held("z0")};
  scene["loads"] = {
      {{"traction", {traction, traction, 0}}, {"where", {{"set", "z1"}}}, {"ramp", 1}}};
  scene["solver"] = {{"static", {{"frames", load_steps}}}, {"threads", 1}};
  scene["output"] = false;
  return read_scene_text(scene.dump(), "inclusions", {}, lookup_of(host), diagnostics);
}

Line solve(PluginHost& host, Index n, double jump, unsigned seed) {
  forget_peak();
  Diagnostics diagnostics;
  Simulation simulation(block(host, n, jump, seed, diagnostics), host, diagnostics);
  Dynamics& dynamics = simulation.built().dynamics();
  const Work work(dynamics);
  const double begin = now(1);
  for (int i = 1; i <= load_steps; ++i) dynamics.step(1. / load_steps, 1. * i / load_steps);
  const double seconds = now(1) - begin;
  const double unknowns = 3.0 * simulation.attributes().vertex_count();
  return Line()
      .add("jump", jump)
      .add("elements", static_cast<double>(simulation.complex().element_count()))
      .add("unknowns", unknowns)
      .add("seconds", seconds)
      .add("us_per_unknown", 1e6 * seconds / unknowns)
      .add("published_us", jump == 100 ? published_us : unknown)
      .add("newton_steps", work.newton)
      .add("krylov_iterations", work.krylov)
      .add("iterations_per_step", work.krylov / work.newton)
      .add("published_iterations", jump == 100 ? published_iterations : unknown)
      .add("peak_mb", peak_bytes() / 1e6);
}

void run_inclusions(const InclusionOptions& options, Report& report) {
  PluginHost host;
  report.begin("inclusions",
               "cube of 1 m with 60 balls that are stiffer by the jump: neo-Hookean, trilinear, nu "
               "0.3, fixed below, pushed aside above in five load steps, equilibria to 1e-8; CPU "
               "s of one thread. Published: Davydov et al. 2020, 4.44 M unknowns on 20 cores");
  for (const Index jump : options.jumps)
    for (const Index n : options.across) report.add(solve(host, n, jump, options.seed));
}

}  // namespace

void add_inclusions(CommandLine& line) {
  auto [command, options] =
      line.add("inclusions", "Static equilibria where the stiffness jumps", run_inclusions);
  command.option("--across", &options.across, "Elements along each edge of the cube");
  command.option("--jumps", &options.jumps, "Moduli of the balls over that of the matrix");
  command.option("--seed", &options.seed, "Of the places of the balls");
}

}  // namespace suture::bench
