// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/dynamics/rest_search.hpp"

namespace suture::bench {
namespace {

struct RestOptions {
  std::vector<Index> across{5, 10};
  double tolerance = 1e-6, ramp = 0.1, safety = 0.8;
};

/// Mean deflection of the free end, m.
double tip(BenchBody& body) {
  double sum = 0;
  int count = 0;
  Attributes& a = body.attributes();
  for (Index v = 0; v < a.vertex_count(); ++v) {
    if (a.rest().get(v, 2) < 1 - 1e-9) continue;
    sum += a.position().get(v, 1) - a.rest().get(v, 1);
    ++count;
  }
  return sum / count;
}

void relax(Index n, const RestOptions& options, PluginHost& host, Report& report) {
  const double begin = now(1);
  BenchBody body(host, {.model = "tm-faure",
                        .cells = {n, n, 4 * n},
                        .cell = 0.25 / n,
                        .ramp = options.ramp,
                        .safety = options.safety,
                        .search = true});
  RestSearch search(options.tolerance, true);
  constexpr double max_steps = 1e6;
  double steps = 0;
  do {
    body.step();
    ++steps;
  } while (!search.at_rest(body.dynamics()) && steps < max_steps);
  report.add(Line()
                 .add("elements", static_cast<double>(body.element_count()))
                 .add("steps", steps)
                 .add("CPU s", now(1) - begin)
                 .add("tip m", tip(body))
                 .add("residual", search.residual())
                 .add("dt s", body.dt())
                 .add("alpha 1/s", body.dynamics().motion().damping()));
}

void run_rest(const RestOptions& options, Report& report) {
  PluginHost host;
  report.begin("rest",
               "cantilever of 1 m under its weight (E 400 kPa, nu 0.3, rho 1000), tm-faure gauss2, "
               "from the mesh to rest, one thread");
  for (const Index n : options.across) relax(n, options, host, report);
}

}  // namespace

void add_rest(CommandLine& line) {
  auto [command, options] =
      line.add("rest", "Time until the paper's cantilever is at rest", run_rest);
  command.option("--across", &options.across, "Cells over the height; four times that along");
  command.option("--tolerance", &options.tolerance, "Residual relative to the load");
  command.option("--ramp", &options.ramp, "Duration of the gravity ramp, s");
  command.option("--safety", &options.safety, "dt relative to the stable step");
}

}  // namespace suture::bench
