// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/operations/tear.hpp"

namespace suture::bench {
namespace {

struct EventOptions {
  std::vector<Index> sizes{4000, 50000, 432000};
  unsigned threads = 1;
  double seconds = 0.5;
};

// A deformed state in which nothing tears, as at almost every look.
void bend(BenchBody& body) {
  Column &x = body.attributes().position(), &rest = body.attributes().rest();
  for (Index v = 0; v < x.size(); ++v)
    for (int c = 0; c < 3; ++c)
      x.set(v, c, rest.get(v, c) * 1.02 + 0.001 * rest.get(v, (c + 1) % 3));
}

/// The force and the look alternate, so that a slow moment of the machine hits both.
void measure_tear(Index size, bool distorted, Tear::By by, const EventOptions& options,
                  PluginHost& host, Report& report) {
  BenchBody body(host, {.model = "tm-faure",
                        .cells = grid_of(size),
                        .distorted = distorted,
                        .threads = options.threads});
  bend(body);
  Tear tear;
  tear.by = by;
  tear.above = 0.3;
  TearCheck check(tear, {}, "/tear");
  const double ns = 1e9 / body.element_count(), part = options.seconds / 5;
  double force = 1e9, look = 1e9;
  for (int round = 0; round < 5; ++round) {
    force = std::min(
        force,
        measure([&] { body.body().models().add_forces(0, 0); }, options.threads, part).median);
    look =
        std::min(look, measure([&] { check.faces(body.body(), 0); }, options.threads, part).median);
  }
  report.add(Line()
                 .add("elements", static_cast<double>(body.element_count()))
                 .add("mesh", distorted ? "general" : "boxes")
                 .add("by", by == Tear::By::elongation ? "elongation" : "principal-strain")
                 .add("force ns/el", ns * force)
                 .add("check ns/el", ns * look)
                 .add("look/force", look / force)
                 .add("every 4: check/force", look / force / 4));
}

void run_events(const EventOptions& options, Report& report) {
  PluginHost host;
  report.begin(
      "tear",
      "a tear check that finds no face, compared with the force of tm-faure; best of 5 medians, " +
          std::to_string(options.threads) + " thread(s)");
  for (const bool distorted : {false, true})
    for (const Tear::By by : {Tear::By::principal_strain, Tear::By::elongation})
      for (const Index size : options.sizes)
        measure_tear(size, distorted, by, options, host, report);
}

}  // namespace

void add_events(CommandLine& line) {
  auto [command, options] =
      line.add("events", "The cost of a tear check relative to the forces", run_events);
  command.option("--sizes", &options.sizes, "Elements");
  command.option("--threads", &options.threads, "Threads").positive();
  command.option("--seconds", &options.seconds, "Time spent on each figure");
}

}  // namespace suture::bench
