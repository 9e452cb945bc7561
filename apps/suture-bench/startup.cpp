// SPDX-License-Identifier: GPL-3.0-or-later
//
// From a scene to its first step: where the time goes, and what stays in memory. startup.py puts
// the time of the whole program before them.
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/machine.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/run/simulation.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture::bench {
namespace {

struct StartupOptions {
  std::vector<Index> sizes{10, 4000, 32000, 432000};
  std::vector<std::string> models{"tm-faure", "mss-baudet"};
  int rounds = 5;
};

/// Bytes of this process in memory now.
double resident() {
  malloc_trim(0);
  std::ifstream file("/proc/self/statm");
  double total = 0, pages = 0;
  file >> total >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

void measure_parts(const std::string& model, Index size, const StartupOptions& options,
                   Report& report) {
  std::vector<BodyTimes> times;
  double elements = 0;
  for (int round = 0; round < options.rounds; ++round) {
    const double start = wall();
    PluginHost host;
    host.model(model);
    const double loaded = wall() - start;
    const BenchBody body(host, {.model = model, .cells = grid_of(size), .search = true});
    elements = body.element_count();
    times.push_back(body.times());
    times.back().plugin = loaded;
  }
  const auto best = [&](double BodyTimes::*part) {
    double least = 1e9;
    for (const BodyTimes& t : times) least = std::min(least, t.*part);
    return 1e3 * least;
  };
  report.add(Line()
                 .add("elements", elements)
                 .add("plugin ms", best(&BodyTimes::plugin))
                 .add("mesh ms", best(&BodyTimes::mesh))
                 .add("map ms", best(&BodyTimes::map))
                 .add("attributes ms", best(&BodyTimes::attributes))
                 .add("loops ms", best(&BodyTimes::loops))
                 .add("stable step ms", best(&BodyTimes::stable_step)));
}

// ----------------------------------------------------------------- memory --

/// A block of cubes under gravity, one end held, for one step that is shorter than any "auto".
Scene block(const std::string& model, const std::array<Index, 3>& cells, PluginHost& host,
            Diagnostics& diagnostics) {
  constexpr double edge = 0.025;
  nlohmann::json scene = nlohmann::json::parse(R"({
    "suture": 1, "gravity": [0, -9.8, 0], "output": false, "solver": {"end": 1e-9, "dt": "auto"},
    "constraints": [{"where": {"set": "z0"}, "fix": "xyz"}]})");
  scene["mesh"]["box"] = {{"size", {edge * cells[0], edge * cells[1], edge * cells[2]}},
                          {"cells", cells}};
  scene["models"] = {{{"model", model}, {"parameters", {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}}}}};
  return read_scene_text(scene.dump(), "block", {}, lookup_of(host), diagnostics);
}

struct Memory {
  double held, peak;  ///< B
};

void reset_peak() { std::ofstream("/proc/self/clear_refs") << 5; }

/// What a run holds after its first step, and at most until then.
Memory memory_of(const std::string& model, const std::array<Index, 3>& cells) {
  const double before = resident();
  reset_peak();
  PluginHost host;
  Diagnostics diagnostics;
  const Scene scene = block(model, cells, host, diagnostics);
  Simulation simulation(scene, host, diagnostics);
  Observer nobody;
  simulation.run(nobody);
  return {resident() - before, peak_bytes() - before};
}

void measure_memory(const std::string& model, const StartupOptions& options, Report& report) {
  memory_of(model, {5, 2, 1});  // loads what stays loaded
  const Memory program = memory_of(model, {5, 2, 1});
  for (const Index size : options.sizes) {
    const auto cells = grid_of(size);
    const double elements = double{1} * cells[0] * cells[1] * cells[2];
    const Memory run = memory_of(model, cells);
    report.add(Line()
                   .add("elements", elements)
                   .add("B/el", std::max(run.held - program.held, 0.0) / elements)
                   .add("peak B/el", std::max(run.peak - program.peak, 0.0) / elements));
  }
}

void run_startup(const StartupOptions& options, Report& report) {
  for (const std::string& model : options.models) {
    report.begin("startup: " + model, "from a box to the first step, best of " +
                                          std::to_string(options.rounds) +
                                          ", wall clock, one thread");
    for (const Index size : options.sizes) measure_parts(model, size, options, report);
    report.begin("memory: " + model,
                 "bytes per element, in excess of a scene of 10 elements: after the first step of "
                 "a scene without cuts and frames, and the peak until then");
    measure_memory(model, options, report);
  }
}

}  // namespace

void add_startup(CommandLine& line) {
  auto [command, options] =
      line.add("startup", "From a scene to its first step; memory", run_startup);
  command.option("--sizes", &options.sizes, "Elements (432000: the 60x60x120 grid)");
  command.option("--models", &options.models, "Models");
  command.option("--rounds", &options.rounds, "Repetitions").positive();
}

}  // namespace suture::bench
