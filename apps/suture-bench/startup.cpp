// SPDX-License-Identifier: GPL-3.0-or-later
//
// From a scene to its first step: where the time goes, and what stays in memory.
#include <malloc.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "kernel/base/error.hpp"

namespace suture::bench {
namespace {

struct Options {
  std::vector<Index> sizes{10, 4000, 32000, 432000};
  std::vector<std::string> models{"tm-faure", "mss-baudet"};
  int rounds = 5;
};

double wall() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Bytes of this process in memory now.
double resident() {
  malloc_trim(0);
  std::ifstream file("/proc/self/statm");
  double total = 0, pages = 0;
  file >> total >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

void measure_parts(const std::string& model, Index size, const Options& options, Report& report) {
  std::vector<BodyTimes> times;
  double bytes = 0, elements = 0;
  for (int round = 0; round < options.rounds; ++round) {
    const double before = resident(), start = wall();
    PluginHost host;
    host.model(model);
    const double loaded = wall() - start;
    Body body(host, {.model = model, .cells = grid_of(size)});
    body.step();
    elements = body.element_count();
    bytes = std::max(bytes, resident() - before);
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
                 .add("stable step ms", best(&BodyTimes::stable_step))
                 .add("B/el", bytes / elements));
}

std::filesystem::path program() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / "suture";
}

/// Seconds of `suture run` on a scene file, start to exit.
double run_program(const std::filesystem::path& scene, bool frames) {
  const std::string path = program().string(), file = scene.string();
  std::vector<const char*> arguments{path.c_str(), "run", "-q", file.c_str()};
  if (!frames) arguments.insert(arguments.end(), {"--set", "/output=false"});
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

void measure_program(const Options& options, Report& report) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("suture-bench-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const auto scene = folder / "ten.json";
  std::ofstream(scene)
      << R"({"suture": 1, "mesh": {"box": {"size": [1, 0.5, 0.1], "cells": [5, 2, 1]}},
    "models": [{"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}],
    "gravity": [0, -9.8, 0], "solver": {"dt": 1e-4, "end": 1e-3},
    "output": {"directory": ")"
      << (folder / "out").string() << "\"}}\n";
  for (const bool frames : {false, true}) {
    double best = 1e9;
    for (int round = 0; round < 4 * options.rounds; ++round)
      best = std::min(best, run_program(scene, frames));
    report.add(Line()
                   .add("scene", std::string("10 elements, 10 steps"))
                   .add("output", std::string(frames ? "2 frames" : "none"))
                   .add("ms", 1e3 * best));
  }
  std::filesystem::remove_all(folder);
}

void run(const Options& options, Report& report) {
  report.begin("startup: the program", "suture run from start to exit, best by the wall clock");
  measure_program(options, report);
  for (const std::string& model : options.models) {
    report.begin("startup: " + model,
                 "from a box to the first step, best of " + std::to_string(options.rounds) +
                     ", wall clock, one thread; B/el: memory of the process that it holds after "
                     "a step, per element");
    for (const Index size : options.sizes) measure_parts(model, size, options, report);
  }
}

}  // namespace

void add_startup(CLI::App& app, std::vector<Command>& commands) {
  auto* command = app.add_subcommand("startup", "From a scene to its first step; memory");
  auto options = std::make_shared<Options>();
  command->add_option("--sizes", options->sizes, "Elements (432000: the 60x60x120 grid)");
  command->add_option("--models", options->models, "Models");
  command->add_option("--rounds", options->rounds, "Repetitions")->check(CLI::PositiveNumber);
  commands.push_back({command, [options](Report& report) { run(*options, report); }});
}

}  // namespace suture::bench
