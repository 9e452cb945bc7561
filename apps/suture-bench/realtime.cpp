// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much liver moves in real time: the largest block that advances 1 s in 1 s, and
// that shows every frame of 1/30 s in time while it is cut every 0.1 s, without and with
// a tool that moves over it.
#include <algorithm>
#include <cmath>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/forces/contact_law.hpp"

namespace suture::bench {
namespace {

struct RealtimeOptions {
  std::vector<unsigned> threads{1, 2};
  Index deep = 24, high = 10;
  double safety = 0.8, frame = 1.0 / 30, cut_every = 0.1;
};

BodyOptions liver(const RealtimeOptions& options, Index layers, unsigned threads) {
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
Index largest_block(const RealtimeOptions& options, unsigned threads, PluginHost& host,
                    Report& report) {
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

/// A block that is shown in frames while it is cut: every 0.1 s another tenth of a plane through
/// the middle. The step is a number, as in a scene that says so: it is not estimated again.
class Shown {
 public:
  Shown(const RealtimeOptions& options, Index layers, unsigned threads, bool with_tool,
        PluginHost& host)
      : options_(options), threads_(threads), body_(host, liver(options, layers, threads)) {
    if (with_tool) add_tool(body_, liver(options, layers, threads));
    advance(body_, lead);
  }
  bool is_over() const { return time_ >= 1; }
  void show_frame() {
    const double start = wall(), own = now(threads_);
    const double end = options_.frame * static_cast<double>(walls_.size() + 1);
    while (time_ + body_.dt() < end && !is_over()) {
      cut_if_due();
      body_.step();
      time_ += body_.dt();
    }
    walls_.push_back(wall() - start);
    processor_.push_back(now(threads_) - own);
  }
  double worst() const { return *std::ranges::max_element(walls_); }
  auto missed() const {
    return std::ranges::count_if(walls_, [&](double t) { return t > options_.frame; });
  }
  /// With one thread, the processor's time, else the wall clock's.
  double median() const {
    std::vector<double> times = processor_;
    std::ranges::nth_element(times, times.begin() + std::ssize(times) / 2);
    return times[times.size() / 2];
  }
  Line line() const {
    return Line()
        .add("threads", static_cast<double>(threads_))
        .add("elements", static_cast<double>(body_.element_count()))
        .add("cuts", static_cast<double>(cuts_))
        .add("faces cut", static_cast<double>(faces_))
        .add("worst frame ms", 1e3 * worst())
        .add("median frame ms (processor)", 1e3 * median())
        .add("frames missed", static_cast<double>(missed()));
  }

 private:
  void cut_if_due() {
    if (time_ < options_.cut_every * (cuts_ + 0.5)) return;
    const auto faces = body_.strip(cuts_++, static_cast<int>(1 / options_.cut_every));
    faces_ += faces.size();
    body_.cut(faces);
  }

  const RealtimeOptions& options_;
  unsigned threads_;
  BenchBody body_;
  double time_ = 0;
  int cuts_ = 0;
  std::size_t faces_ = 0;
  std::vector<double> walls_, processor_;  ///< s, by frame
};

/// Fewer layers until no frame is late. Returns how many.
Index largest_shown(const RealtimeOptions& options, Index layers, unsigned threads,
                    PluginHost& host, Report& report) {
  for (;; layers = std::max<Index>(1, std::min(layers - 1, layers * 96 / 100))) {
    Shown shown(options, layers, threads, false, host);
    while (!shown.is_over()) shown.show_frame();
    report.add(shown.line());
    if (shown.missed() == 0 || layers == 1) return layers;
  }
}

/// The block without the tool, with it, and with it in a smaller block, frame by frame in turn, so
/// that what else the machine does falls on all of them. By how the time of a frame with the tool
/// grows with the block, the part of the elements whose frames take as long as those without it.
void compare_tool(const RealtimeOptions& options, Index layers, unsigned threads, PluginHost& host,
                  Report& report) {
  const Index fewer = layers * 4 / 5;
  Shown plain(options, layers, threads, false, host),
      with_tool(options, layers, threads, true, host), smaller(options, fewer, threads, true, host);
  while (!plain.is_over())
    for (Shown* shown : {&plain, &with_tool, &smaller}) shown->show_frame();
  const double slope = (with_tool.median() - smaller.median()) / (layers - fewer);
  const double equal = layers - (with_tool.median() - plain.median()) / slope;
  const auto add = [&](const Shown& shown, const char* tool) {
    report.add(shown.line().add("tool", tool).add("elements with tool %", 100 * equal / layers));
  };
  add(plain, "no");
  add(with_tool, "yes");
  add(smaller, "yes");
}

void run_realtime(const RealtimeOptions& options, Report& report) {
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
  for (std::size_t i = 0; i < layers.size(); ++i)
    layers[i] = largest_shown(options, layers[i], options.threads[i], host, report);
  report.begin("realtime, cut and tool",
               "the last of these blocks without and with a sphere of ten elements that is pressed "
               "in by two and moves along the block, friction 0.2; and four fifths of the block "
               "with it; frame by frame in turn");
  for (std::size_t i = 0; i < layers.size(); ++i)
    compare_tool(options, layers[i], options.threads[i], host, report);
}

}  // namespace

void add_realtime(CommandLine& line) {
  auto [command, options] =
      line.add("realtime", "The largest block that runs in real time", run_realtime);
  command.option("--threads", &options.threads, "Threads").positive();
  command.option("--deep", &options.deep, "Cells over the depth");
  command.option("--high", &options.high, "Cells over the height");
}

}  // namespace suture::bench
