// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <functional>
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
  std::string only;  ///< of the kinds of events
};

struct EventCostOptions {
  std::array<Index, 3> small{22, 22, 21}, large{108, 108, 108};
  int rounds = 5;
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
  if (std::string_view(what).find(options.only) == std::string_view::npos) return;
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
                 .add("divided", static_cast<double>(last_cut.summary.elements_cut))
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
        std::get<CutBlade>(blade.events[0].what).along_blade = true;
        compare("a blade that divides elements", plain, blade, options, host, report);
      }
}

// ------------------------------------------------------------- one operation --

struct Operation {
  const char* name;
  std::function<Event(const std::array<Index, 3>& cells, int round)> event;
};

std::uint64_t element_at(const std::array<Index, 3>& n, Index x, Index y, Index z) {
  return x + n[0] * (y + std::uint64_t{n[1]} * z);
}

Event with(decltype(Event::what) what) {
  Event event = event_number(0);
  event.what = std::move(what);
  return event;
}

Pierce pierce_of(decltype(Selection::what) what) {
  Pierce pierce;
  pierce.where = Selection{};
  pierce.where->path = "/events/0/pierce";
  pierce.where->what = std::move(what);
  return pierce;
}

/// In the middle of a block, each round elsewhere.
std::vector<Operation> operations() {
  using Cells = std::array<Index, 3>;
  const auto pair = [](const Cells& n, int round) {
    const Index y = n[1] / 4 + 2 * static_cast<Index>(round);
    const std::uint64_t element = element_at(n, n[0] / 2, y, n[2] / 2);
    return std::vector<std::array<std::uint64_t, 2>>{{element, element + 1}};
  };
  const auto place = [](const Cells& n, int round) {
    return Vec3{block_edge * (n[0] / 4), block_edge * (n[1] / 4 + 2 * round + 0.5),
                block_edge * (n[2] / 4 + 0.5)};
  };
  return {
      {"remove an element by its id",
       [](const Cells& n, int round) {
         return with(pierce_of(Selection::Ids{
             {element_at(n, n[0] / 2, n[1] / 4 + 2 * static_cast<Index>(round), n[2] / 3)}}));
       }},
      {"remove the nearest element",
       [](const Cells& n, int round) {
         return with(pierce_of(Selection::Nearest{{block_edge * (n[0] / 3 + 0.5),
                                                   block_edge * (n[1] / 4 + 2 * round + 0.5),
                                                   block_edge * (n[2] / 2 + 0.5)}}));
       }},
      {"cut a face", [=](const Cells& n, int round) { return with(CutFaces{pair(n, round)}); }},
      {"sew it",
       [=](const Cells& n, int round) {
         SewFaces sew;
         sew.element_pairs = pair(n, round);
         return with(std::move(sew));
       }},
      {"cut by a disc",
       [=](const Cells& n, int round) {
         CutPlane disc{place(n, round), {1, 0, 0}};
         disc.radius = 2 * block_edge;
         return with(std::move(disc));
       }},
      {"cut by two triangles",
       [=](const Cells& n, int round) {
         Vec3 p = place(n, round);
         p[0] += block_edge;  // where the disc has not cut
         const double a = 2 * block_edge;
         TriangleSurface square{"square", {}, {{0, 1, 2}, {0, 2, 3}}};
         for (const auto& [y, z] : {std::pair{-a, -a}, {a, -a}, {a, a}, {-a, a}})
           square.points.push_back({p[0], p[1] + y, p[2] + z});
         CutSurface cut;
         cut.surface = std::make_shared<const TriangleSurface>(std::move(square));
         return with(std::move(cut));
       }},
      {"tear in a ball", [=](const Cells& n, int round) {
         Tear tear;
         tear.max_fraction = 1;
         tear.where = Selection{Selection::Sphere{place(n, round), 2 * block_edge}, "/events/0"};
         return with(std::move(tear));
       }}};
}

/// us of each operation in a run of a block, medians.
std::vector<double> operation_times(PluginHost& host, const std::string& model,
                                    const std::array<Index, 3>& cells, int rounds) {
  EventRunOptions options;
  options.cells = cells;
  const Scene scene = event_block(host, model, false, false, options);
  Diagnostics diagnostics;
  Observer nobody;
  Simulation simulation(scene, host, diagnostics);
  std::vector<double> medians;
  double time = 0;
  for (const Operation& operation : operations()) {
    std::vector<double> times;
    for (int round = 0; round < rounds; ++round) {
      simulation.run_to(time += 2 * *scene.solver.dt, nobody);
      const Event event = operation.event(cells, round);
      const double start = now(1);
      simulation.apply(event, nobody);
      times.push_back(1e6 * (now(1) - start));
    }
    medians.push_back(median(times));
  }
  return medians;
}

void run_event_costs(const EventCostOptions& options, Report& report) {
  PluginHost host;
  report.begin("event costs",
               "one operation in a run of symplectic Euler, whole event, medians of " +
                   std::to_string(options.rounds) + ", 1 thread");
  for (const char* model : {"tm-faure", "mss-baudet"}) {
    const std::vector<double> small = operation_times(host, model, options.small, options.rounds),
                              large = operation_times(host, model, options.large, options.rounds);
    for (std::size_t i = 0; i < small.size(); ++i)
      report.add(Line()
                     .add("operation", operations()[i].name)
                     .add("model", model)
                     .add("small us", small[i])
                     .add("large us", large[i])
                     .add("large/small", large[i] / small[i]));
  }
}

}  // namespace

void add_event_costs(CommandLine& line) {
  auto [command, options] = line.add(
      "event-costs", "One operation in a large run compared with a small", run_event_costs);
  command.option("--small", &options.small, "Elements of the small block along each axis");
  command.option("--large", &options.large, "Elements of the large block along each axis");
  command.option("--rounds", &options.rounds, "Operations of each kind").positive();
}

void add_event_runs(CommandLine& line) {
  auto [command, options] =
      line.add("event-runs", "Whole runs with events compared with runs without", run_event_runs);
  command.option("--cells", &options.cells, "Elements along each axis");
  command.option("--pairs", &options.pairs, "Pairs of runs").positive();
  command.option("--cuts", &options.cuts, "Cuts of one face");
  command.option("--steps", &options.steps, "Steps of a run with a fixed dt").positive();
  command.option("--only", &options.only, "A part of the names of the events that are measured");
}

}  // namespace suture::bench
