// SPDX-License-Identifier: GPL-3.0-or-later
//
// From a scene to its first step: where the time goes, and what stays in memory.
#include <malloc.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

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

/// Scene files, and a folder for them that is removed again.
class Scenes {
 public:
  Scenes() { std::filesystem::create_directories(folder_); }
  ~Scenes() { std::filesystem::remove_all(folder_); }
  Scenes(const Scenes&) = delete;
  Scenes& operator=(const Scenes&) = delete;

  /// A block of cubes under gravity, one end held, for some steps of `dt`.
  std::filesystem::path write(const std::string& model, const std::array<Index, 3>& cells,
                              const char* dt, double end) const {
    std::ostringstream size, count;
    for (std::size_t c = 0; c < 3; ++c) {
      size << (c ? ", " : "") << 0.025 * cells[c];
      count << (c ? ", " : "") << cells[c];
    }
    const auto file = folder_ / "block.json";
    std::ofstream(file) << R"({"suture": 1, "mesh": {"box": {"size": [)" << size.str()
                        << R"(], "cells": [)" << count.str() << R"(]}}, "models": [{"model": ")"
                        << model << R"(", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}],
    "constraints": [{"where": {"set": "z0"}, "fix": "xyz"}],
    "gravity": [0, -9.8, 0], "solver": {"end": )"
                        << end << R"(, "dt": )" << dt << R"(},
    "output": {}}
)";
    return file;
  }

 private:
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("suture-bench-" + std::to_string(getpid()));
};

constexpr double one_step = 1e-9;  // s: below any "auto"
constexpr const char* no_output = "/output=false";

/// Seconds of `suture run` on a scene file, start to exit.
double run_program(const std::filesystem::path& scene, bool frames) {
  const std::string path = suture_program().string(), file = scene.string(),
                    out = (scene.parent_path() / "out").string();
  std::vector<const char*> arguments{path.c_str(), "run", "-q", file.c_str()};
  if (frames)
    arguments.insert(arguments.end(), {"--output", out.c_str()});
  else
    arguments.insert(arguments.end(), {"--set", no_output});
  arguments.push_back(nullptr);
  const double start = wall();
  pid_t child = 0;
  int status = 0;
  const int failed = posix_spawn(&child, path.c_str(), nullptr, nullptr,
                                 const_cast<char* const*>(arguments.data()), environ);
  if (failed != 0 || waitpid(child, &status, 0) < 0 || status != 0)
    throw IoError("cannot run " + path + " on " + file);
  return wall() - start;
}

void measure_program(const Scenes& scenes, const StartupOptions& options, Report& report) {
  const auto scene = scenes.write("tm-faure", {5, 2, 1}, "1e-4", 1e-3);
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

void measure_memory(const Scenes& scenes, const std::string& model, const StartupOptions& options,
                    Report& report) {
  const auto ten = scenes.write(model, {5, 2, 1}, "\"auto\"", one_step);
  memory_of(ten);  // loads what stays loaded
  const Memory program = memory_of(ten);
  for (const Index size : options.sizes) {
    const auto cells = grid_of(size);
    const double elements = double{1} * cells[0] * cells[1] * cells[2];
    const Memory run = memory_of(scenes.write(model, cells, "\"auto\"", one_step));
    report.add(Line()
                   .add("elements", elements)
                   .add("B/el", std::max(run.held - program.held, 0.0) / elements)
                   .add("peak B/el", std::max(run.peak - program.peak, 0.0) / elements));
  }
}

void run_startup(const StartupOptions& options, Report& report) {
  report.begin("startup: the program", "suture run from start to exit, best wall-clock time");
  const Scenes scenes;
  measure_program(scenes, options, report);
  for (const std::string& model : options.models) {
    report.begin("startup: " + model, "from a box to the first step, best of " +
                                          std::to_string(options.rounds) +
                                          ", wall clock, one thread");
    for (const Index size : options.sizes) measure_parts(model, size, options, report);
    report.begin("memory: " + model,
                 "bytes per element, in excess of a scene of 10 elements: after the first step of "
                 "a scene without cuts and frames, and the peak until then");
    measure_memory(scenes, model, options, report);
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
