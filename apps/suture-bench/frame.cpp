// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a frame costs the simulation thread: copies, while the writer compresses and
// writes the frames before it.
#include <algorithm>

#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/frames.hpp"
#include "apps/suture-bench/timer.hpp"

namespace suture::bench {
namespace {

struct FrameOptions {
  std::vector<Index> sides{10, 30, 60};
  int rounds = 9;
};

void measure_side(Index side, const FrameOptions& options, PluginHost& host, Report& report) {
  Frames frames(host, {side, side, side}, {"displacement", "velocity"}, true);
  std::vector<double> processor, wall;
  for (int round = 0; round < options.rounds; ++round) {
    frames.wait();  // steps between frames give the writer time
    const double start = now(1), wall_start = now(2);
    frames.write();
    processor.push_back(now(1) - start);
    wall.push_back(now(2) - wall_start);
  }
  const auto median = [](std::vector<double>& v) {
    std::sort(v.begin(), v.end());
    return 1e3 * v[v.size() / 2];
  };
  report.add(Line()
                 .add("elements", static_cast<double>(side) * side * side)
                 .add("CPU ms", median(processor))
                 .add("wall-clock ms", median(wall)));
}

void run_frame(const FrameOptions& options, Report& report) {
  PluginHost host;
  report.begin("frame", "displacement and velocity, lz4; simulation thread, medians");
  for (const Index side : options.sides) measure_side(side, options, host, report);
}

}  // namespace

void add_frame(CommandLine& line) {
  auto [command, options] = line.add("frame", "The cost of a frame to the simulation", run_frame);
  command.option("--sides", &options.sides, "n of the cubes n x n x n (60: 216,000)");
  command.option("--rounds", &options.rounds, "Frames").positive();
}

}  // namespace suture::bench
