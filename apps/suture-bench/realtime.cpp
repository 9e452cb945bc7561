// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much liver moves in real time: the largest block that advances 1 s in 1 s, and
// that shows every frame of 1/30 s in time while it is cut every 0.1 s, without and with
// a tool that moves over it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "kernel/contact/contact.hpp"

namespace suture::bench {
namespace {

struct Options {
  std::vector<unsigned> threads{1, 2};
  Index deep = 24, high = 10;
  double safety = 0.8, frame = 1.0 / 30, cut_every = 0.1;
};

double wall() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

BodyOptions liver(const Options& options, Index layers, unsigned threads) {
  return {.model = "tm-faure",
          .parameters = {{"E", 10e3}, {"nu", 0.45}, {"rho", 1000}},
          .cells = {layers, options.deep, options.high},
          .threads = threads,
          .cell = 0.005,
          .ramp = 0.1,
          .safety = options.safety,
          .search = true,
          .gravity = {0, 0, -9.8}};
}

constexpr double lead = 0.1;  // s before the first frame

/// A sphere of ten elements that is pressed in by two and moves along the block in 1 s.
void add_tool(BenchBody& body, const BodyOptions& liver) {
  const double radius = 5 * liver.cell, height = liver.cell * liver.cells[2];
  const double length = liver.cell * liver.cells[0];
  Obstacle tool{"tool",
                "",
                Sphere{{2 * radius, liver.cell * liver.cells[1] / 2, height + radius}, radius},
                {},
                0.2};
  const double depth = -2 * liver.cell;
  tool.motion.stations = {{0, {}, 0},
                          {lead, {0, 0, depth}, 0},
                          {lead + 1, {std::max(0.0, length - 4 * radius), 0, depth}, 0}};
  body.body().add_contact({tool}, 0);
  body.dynamics().start();
}

/// Seconds to advance `time`.
double advance(BenchBody& body, double time) {
  const double start = wall();
  for (double t = 0; t < time; t += body.dt()) body.step();
  return wall() - start;
}

/// Layers whose simulation takes as long as it lasts, by its time per layer and two
/// corrections.
Index largest_block(const Options& options, unsigned threads, PluginHost& host, Report& report) {
  Index layers = 50;
  for (int correction = 0; correction < 3; ++correction) {
    BenchBody body(host, liver(options, layers, threads));
    advance(body, lead);
    const double seconds = std::min({advance(body, 1), advance(body, 1), advance(body, 1)});
    report.add(Line()
                   .add("threads", static_cast<double>(threads))
                   .add("elements", static_cast<double>(body.element_count()))
                   .add("dt s", body.dt())
                   .add("stable dt s", body.dt() / options.safety)
                   .add("s per s", seconds)
                   .add("M el/s", 1e-6 * body.element_count() / (seconds * body.dt())));
    layers = std::max<Index>(1, static_cast<Index>(layers * 0.99 / seconds));
  }
  return layers;
}

struct Frames {
  double worst = 0;  ///< s
  int missed = 0, cuts = 0;
  Index faces = 0;
};

/// One second in frames. Every 0.1 s another tenth of a plane through the middle is
/// cut. The step is a number, as in a scene that says so: it is not estimated again.
Frames show(BenchBody& body, const Options& options) {
  Frames result;
  double next_frame = options.frame, next_cut = options.cut_every / 2, start = wall();
  for (double t = 0; t < 1; t += body.dt()) {
    if (t >= next_cut) {
      const auto faces = body.strip(result.cuts++, static_cast<int>(1 / options.cut_every));
      result.faces += static_cast<Index>(faces.size());
      body.cut(faces);
      next_cut += options.cut_every;
    }
    body.step();
    if (t + body.dt() < next_frame) continue;
    const double spent = wall() - start;
    result.worst = std::max(result.worst, spent);
    result.missed += spent > options.frame;
    next_frame += options.frame;
    start = wall();
  }
  return result;
}

/// Fewer layers until no frame is late.
void largest_shown(const Options& options, Index layers, unsigned threads, bool with_tool,
                   PluginHost& host, Report& report) {
  for (; layers > 0; layers = std::min(layers - 1, layers * 96 / 100)) {
    BenchBody body(host, liver(options, layers, threads));
    if (with_tool) add_tool(body, liver(options, layers, threads));
    advance(body, lead);
    const Frames frames = show(body, options);
    report.add(Line()
                   .add("threads", static_cast<double>(threads))
                   .add("elements", static_cast<double>(body.element_count()))
                   .add("cuts", static_cast<double>(frames.cuts))
                   .add("faces cut", static_cast<double>(frames.faces))
                   .add("worst frame ms", 1e3 * frames.worst)
                   .add("frames missed", static_cast<double>(frames.missed)));
    if (frames.missed == 0) return;
  }
}

void run(const Options& options, Report& report) {
  PluginHost host;
  std::vector<Index> layers;
  report.begin("realtime",
               "slab of liver (tm-faure, E 10 kPa, nu 0.45, rho 1000), elements of 5 mm, 10 layers "
               "high, fixed to a plate, under its weight; dt = 0.8 of the stability limit (search "
               "at rest), "
               "best of 3 s");
  for (const unsigned threads : options.threads)
    layers.push_back(largest_block(options, threads, host, report));
  report.begin("realtime, cut",
               "the same while a tenth of the middle plane is cut every 0.1 s: with fewer "
               "elements, until every frame of 1/30 s is on time");
  const auto shown = [&](bool with_tool) {
    for (std::size_t i = 0; i < layers.size(); ++i)
      largest_shown(options, layers[i], options.threads[i], with_tool, host, report);
  };
  shown(false);
  report.begin("realtime, cut and tool",
               "the same with a sphere of ten elements that is pressed in by two and moves along "
               "the block, friction 0.2");
  shown(true);
}

}  // namespace

void add_realtime(CLI::App& app, std::vector<Command>& commands) {
  auto* command = app.add_subcommand("realtime", "The largest block that runs in real time");
  auto options = std::make_shared<Options>();
  command->add_option("--threads", options->threads, "Threads")->check(CLI::PositiveNumber);
  command->add_option("--deep", options->deep, "Cells over the depth");
  command->add_option("--high", options->high, "Cells over the height");
  commands.push_back({command, [options](Report& report) { run(*options, report); }});
}

}  // namespace suture::bench
