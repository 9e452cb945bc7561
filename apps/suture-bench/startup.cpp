// SPDX-License-Identifier: GPL-3.0-or-later
//
// From a scene to its first step: where the time goes, and what stays in memory.
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/machine.hpp"
#include "apps/suture-bench/process.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/base/error.hpp"
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

// ------------------------------------------------------------ the program --

constexpr double one_step = 1e-9;  // s: below any "auto"
constexpr const char* no_output = "/output=false";

/// Writes a scene: a block of cubes under gravity, one end held, for some steps of `dt`.
std::filesystem::path write_scene(const WorkingFolder& folder, const std::string& model,
                                  const std::array<Index, 3>& cells, const nlohmann::json& dt,
                                  double end) {
  constexpr double edge = 0.025;
  nlohmann::json scene = nlohmann::json::parse(R"({
    "suture": 1, "gravity": [0, -9.8, 0], "output": {},
    "constraints": [{"where": {"set": "z0"}, "fix": "xyz"}]})");
  scene["mesh"]["box"] = {{"size", {edge * cells[0], edge * cells[1], edge * cells[2]}},
                          {"cells", cells}};
  scene["models"] = {{{"model", model}, {"parameters", {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}}}}};
  scene["solver"] = {{"end", end}, {"dt", dt}};
  const auto file = folder.path() / "block.json";
  std::ofstream(file) << scene;
  return file;
}

/// Seconds of `suture run` on a scene file, start to exit.
double run_program(const std::filesystem::path& scene, bool frames) {
  std::vector<std::string> words{suture_program(), "run", "-q", scene};
  if (!frames) words.insert(words.end(), {"--set", no_output});
  const ProcessUse use = run_process(words, scene.parent_path());
  if (use.code != 0) throw IoError("cannot run " + words[0] + " on " + scene.string());
  return use.wall;
}

void measure_program(const WorkingFolder& folder, const StartupOptions& options, Report& report) {
  const auto scene = write_scene(folder, "tm-faure", {5, 2, 1}, 1e-4, 1e-3);
  for (const bool frames : {false, true}) {
    double best = 1e9;
    for (int round = 0; round < 4 * options.rounds; ++round)
      best = std::min(best, run_program(scene, frames));
    report.add(Line()
                   .add("scene", std::string("10 elements, 10 steps"))
                   .add("output", std::string(frames ? "2 frames" : "none"))
                   .add("ms", 1e3 * best));
  }
}

// ----------------------------------------------------------------- memory --

struct Memory {
  double held, peak;  ///< B
};

void reset_peak() { std::ofstream("/proc/self/clear_refs") << 5; }

/// What a run holds after its first step, and at most until then.
Memory memory_of(const std::filesystem::path& file) {
  const double before = resident();
  reset_peak();
  PluginHost host;
  Diagnostics diagnostics;
  const Scene scene = read_scene(file, {no_output}, host, diagnostics);
  Simulation simulation(scene, host, diagnostics);
  Observer nobody;
  simulation.run(nobody);
  return {resident() - before, peak_bytes() - before};
}

void measure_memory(const WorkingFolder& folder, const std::string& model,
                    const StartupOptions& options, Report& report) {
  const auto ten = write_scene(folder, model, {5, 2, 1}, "auto", one_step);
  memory_of(ten);  // loads what stays loaded
  const Memory program = memory_of(ten);
  for (const Index size : options.sizes) {
    const auto cells = grid_of(size);
    const double elements = double{1} * cells[0] * cells[1] * cells[2];
    const Memory run = memory_of(write_scene(folder, model, cells, "auto", one_step));
    report.add(Line()
                   .add("elements", elements)
                   .add("B/el", std::max(run.held - program.held, 0.0) / elements)
                   .add("peak B/el", std::max(run.peak - program.peak, 0.0) / elements));
  }
}

void run_startup(const StartupOptions& options, Report& report) {
  report.begin("startup: the program", "suture run from start to exit, best wall-clock time");
  const WorkingFolder folder;
  measure_program(folder, options, report);
  for (const std::string& model : options.models) {
    report.begin("startup: " + model, "from a box to the first step, best of " +
                                          std::to_string(options.rounds) +
                                          ", wall clock, one thread");
    for (const Index size : options.sizes) measure_parts(model, size, options, report);
    report.begin("memory: " + model,
                 "bytes per element, in excess of a scene of 10 elements: after the first step of "
                 "a scene without cuts and frames, and the peak until then");
    measure_memory(folder, model, options, report);
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
