// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <random>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/run/simulation.hpp"

namespace suture::bench {
namespace {

struct EventRunOptions {
  std::array<Index, 3> cells{40, 22, 22};
  int pairs = 5;
  unsigned cuts = 80;
  int steps = 500;
};

constexpr double block_edge = 0.05;  // m

/// A block of the paper's material, held at one end, that sags a little.
Scene event_block(PluginHost& host, const std::string& model, bool verlet, bool automatic,
                  const EventRunOptions& options) {
  const auto& n = options.cells;
  Scene scene;
  scene.mesh.box = BoxOptions{
      {0, 0, 0}, {block_edge * n[0], block_edge * n[1], block_edge * n[2]}, n, {1, 1, 1}};
  ModelUse use;
  use.name = model;
  use.model = &host.model(model);
  use.parameters = parameters_of(*use.model, {});
  scene.models.push_back(use);
  scene.gravity = {0, -0.5, 0};
  Constraint clamp;
  clamp.where.what = Selection::Named{"x1"};
  scene.constraints.push_back(clamp);
  if (verlet) scene.solver.integrator = "velocity-verlet";
  const double dt = 8e-4;  // below the bound
  if (!automatic) scene.solver.dt = dt;
  scene.solver.end = dt * options.steps;
  scene.solver.threads = 1;
  scene.output.enabled = false;
  return scene;
}

Event event_number(std::size_t i) {
  Event event;
  event.path = "/events/" + std::to_string(i);
  return event;
}

void add_cuts(Scene& scene, const EventRunOptions& options) {
  std::mt19937 random(1);
  const auto& n = options.cells;
  for (unsigned i = 0; i < options.cuts; ++i) {
    const Index x = random() % (n[0] - 1), y = random() % n[1], z = random() % n[2];
    const std::uint64_t element = x + n[0] * (y + std::uint64_t{n[1]} * z);
    Event event = event_number(i);
    event.at = *scene.solver.end * (i + 1) / (options.cuts + 1);
    event.what = CutFaces{{{element, element + 1}}};
    scene.events.push_back(event);
  }
}

/// An oblique blade in the middle plane: it comes to some links in almost every step.
void add_blade(Scene& scene, const EventRunOptions& options) {
  const auto& n = options.cells;
  const double y = block_edge * (n[1] / 2 + 0.06), width = block_edge * n[2],
               end = *scene.solver.end;
  const auto blade = [&](double x) {
    return std::vector<Vec3>{{x, y, -block_edge}, {x + width, y, width + block_edge}};
  };
  Event event = event_number(0);
  event.what = CutBlade{
      {{0, blade(-width - 2 * block_edge)}, {end, blade(block_edge * (n[0] - 4.0) - width)}}};
  scene.events.push_back(event);
}

struct Run {
  double seconds;
  RunSummary summary;
};

Run run_of(const Scene& scene, PluginHost& host) {
  Diagnostics diagnostics;
  Observer nobody;
  Simulation simulation(scene, host, diagnostics);
  const double start = now(1);
  RunSummary summary = simulation.run(nobody);
  return {now(1) - start, std::move(summary)};
}

/// Runs without and with the events in turn, so that a slow moment of the machine hits both.
void compare(const char* what, const Scene& without, const Scene& with,
             const EventRunOptions& options, PluginHost& host, Report& report) {
  std::vector<double> ratios, plain, cut;
  Run last_plain{}, last_cut{};
  for (int pair = 0; pair < options.pairs; ++pair) {
    last_plain = run_of(without, host);
    last_cut = run_of(with, host);
    plain.push_back(last_plain.seconds);
    cut.push_back(last_cut.seconds);
    ratios.push_back(last_cut.seconds / last_plain.seconds);
  }
  const auto steps = [](const Run& run) { return static_cast<double>(run.summary.steps); };
  report.add(Line()
                 .add("events", what)
                 .add("model", without.models[0].name)
                 .add("integrator", without.solver.integrator == "velocity-verlet"
                                        ? "velocity-verlet"
                                        : "symplectic-euler")
                 .add("dt", without.solver.dt ? "fixed" : "auto")
                 .add("faces cut", static_cast<double>(last_cut.summary.faces_cut))
                 .add("without s", median(plain))
                 .add("with s", median(cut))
                 .add("with/without", median(ratios))
                 .add("steps with/without", steps(last_cut) / steps(last_plain)));
}

void run_event_runs(const EventRunOptions& options, Report& report) {
  PluginHost host;
  report.begin("event runs",
               "whole runs with events relative to runs without, start-up not timed; " +
                   std::to_string(options.cells[0] * options.cells[1] * options.cells[2]) +
                   " elements, medians of " + std::to_string(options.pairs) + " pairs, 1 thread");
  for (const char* model : {"tm-faure", "mss-baudet"})
    for (const bool verlet : {false, true})
      for (const bool automatic : {false, true}) {
        const Scene plain = event_block(host, model, verlet, automatic, options);
        Scene cuts = plain, blade = plain;
        add_cuts(cuts, options);
        add_blade(blade, options);
        compare("cuts of one face", plain, cuts, options, host, report);
        compare("a blade in every step", plain, blade, options, host, report);
      }
}

}  // namespace

void add_event_runs(CommandLine& line) {
  auto [command, options] =
      line.add("event-runs", "Whole runs with events compared with runs without", run_event_runs);
  command.option("--cells", &options.cells, "Elements along each axis");
  command.option("--pairs", &options.pairs, "Pairs of runs").positive();
  command.option("--cuts", &options.cuts, "Cuts of one face");
  command.option("--steps", &options.steps, "Steps of a run with a fixed dt").positive();
}

}  // namespace suture::bench
