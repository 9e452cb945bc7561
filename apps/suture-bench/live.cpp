// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the pictures of a live run cost the thread of the simulation.
#include <algorithm>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/live/picture.hpp"

namespace suture::bench {
namespace {

struct LiveOptions {
  std::vector<Index> sides{27, 100};
  std::vector<std::string> fields{"displacement", "von_mises"};
  int rounds = 9;
};

Scene block(PluginHost& host, Index side) {
  Scene scene;
  scene.mesh.box = BoxOptions{{0, 0, 0}, {1, 1, 1}, {side, side, side}, {1, 1, 1}};
  ModelUse use;
  use.name = "tm-faure";
  use.model = &host.model(use.name);
  use.parameters = parameters_of(*use.model, {{"E", 10e3}, {"nu", 0.4}, {"rho", 1000}});
  scene.models.push_back(use);
  scene.solver.threads = 1;
  scene.output.enabled = false;
  return scene;
}

/// A disc between two layers of elements.
Event disc_cut(Index side, double radius) {
  CutPlane plane;
  plane.point = {(side / 2) / double(side), 0.5, 0.5};
  plane.normal = {1, 0, 0};
  plane.radius = radius;
  Event event;
  event.path = "/events/0";
  event.what = plane;
  return event;
}

/// Medians, while a disc that is cut inside grows.
void measure_side(Index side, const LiveOptions& options, PluginHost& host, Report& report) {
  const Scene scene = block(host, side);
  Diagnostics diagnostics;
  Simulation simulation(scene, host, diagnostics);
  Pictures pictures(simulation, 0);
  Observer nobody;
  LiveStatus status;
  double radius = 0.05;
  for (const std::string& field : options.fields) {
    pictures.choose(field);
    std::vector<double> same, cut;
    LivePicture picture = pictures.picture(status);
    for (int round = 0; round < options.rounds; ++round) {
      simulation.advance({{}, 1}, nobody);
      double start = now(1);
      picture = pictures.picture(status);
      same.push_back(now(1) - start);
      radius += 0.4 / static_cast<double>(options.rounds * options.fields.size());
      simulation.apply(disc_cut(side, radius), nobody);
      start = now(1);
      pictures.picture(status);
      cut.push_back(now(1) - start);
    }
    report.add(Line()
                   .add("elements", static_cast<double>(side) * side * side)
                   .add("field", field)
                   .add("kB", static_cast<double>(picture.state->size()) / 1e3)
                   .add("ms", 1e3 * median(same))
                   .add("ms after a cut", 1e3 * median(cut)));
  }
}

void run_live(const LiveOptions& options, Report& report) {
  PluginHost host;
  report.begin("live",
               "pictures of a cube that stands still, on the thread of the simulation; processor "
               "time, medians; a cut lays a disc open");
  for (const Index side : options.sides) measure_side(side, options, host, report);
}

}  // namespace

void add_live(CommandLine& line) {
  auto [command, options] = line.add("live", "The cost of pictures of a live run", run_live);
  command.option("--sides", &options.sides, "n of the cubes n x n x n");
  command.option("--fields", &options.fields, "Fields shown");
  command.option("--rounds", &options.rounds, "Pictures").positive();
}

}  // namespace suture::bench
