// SPDX-License-Identifier: GPL-3.0-or-later
//
// The paper's Fig. 8: growing beams of cubes of 0.025 m, on one thread and on many; and static
// equilibria likewise.
#include <algorithm>
#include <thread>
#include <vector>

#include "apps/suture-bench/cantilever.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/machine.hpp"
#include "apps/suture-bench/timer.hpp"

namespace suture::bench {
namespace {

struct ScalingCase {
  const char* name;
  const char* model;
  std::map<std::string, double> parameters;
};

const std::vector<ScalingCase>& scaling_cases() {
  static const std::vector<ScalingCase> list{{"TM", "tm-faure", {}},
                                             {"MSS", "mss-baudet", {}},
                                             {"MSS, viscosity", "mss-baudet", {{"viscosity", 1}}}};
  return list;
}

struct ScalingOptions {
  std::vector<Index> across{5, 8, 10, 15, 20, 30, 48};
  unsigned threads = std::max(1u, std::thread::hardware_concurrency());
  int rounds = 7;
  double seconds = 0.05;
};

/// One thread and many take turns, so that a slow moment of the machine hits both;
/// the wall clock counts for both.
struct Alternating {
  double one = 1e9, many = 1e9;
  template <class One, class Many>
  Alternating(const ScalingOptions& options, One one_thread, Many many_threads) {
    constexpr unsigned wall = 2;
    for (int round = 0; round < options.rounds; ++round) {
      one = std::min(one, measure(one_thread, wall, options.seconds).median);
      many = std::min(many, measure(many_threads, wall, options.seconds).median);
    }
  }
  double speed_up() const { return one / many; }
};

void measure_beam(const ScalingCase& c, Index n, const ScalingOptions& options, PluginHost& host,
                  Report& report) {
  BodyOptions body{.model = c.model, .parameters = c.parameters, .cells = {n, n, 4 * n}};
  BenchBody one(host, body);
  body.threads = options.threads;
  BenchBody many(host, body);
  const Alternating step(
      options, [&] { one.step(); }, [&] { many.step(); });
  const Alternating force(
      options, [&] { one.body().models().add_forces(0, 0); },
      [&] { many.body().models().add_forces(0, 0); });
  const double elements = one.element_count();
  report.add(Line()
                 .add("elements", elements)
                 .add("sequential ms/step", 1e3 * step.one)
                 .add("parallel ms/step", 1e3 * step.many)
                 .add("speed-up", step.speed_up())
                 .add("of forces", force.speed_up())
                 .add("M el/s", 1e-6 * elements / step.many)
                 .add("s per s", step.many / many.dt()));
}

/// The wall clock of an equilibrium from rest.
double seconds_of_equilibrium(PluginHost& host, Index n, unsigned threads) {
  BodyOptions options = options_of(cantilever("A0.25"), host.model("tm-faure"),
                                   {.across = n, .element = "trilinear"});
  options.threads = threads;
  BenchBody body(host, options);
  const double begin = wall();
  body.dynamics().step(1, 1);
  return wall() - begin;
}

void measure_equilibrium(Index n, const ScalingOptions& options, PluginHost& host, Report& report) {
  std::vector<double> one, many;
  for (int round = 0; round < std::min(options.rounds, 3); ++round) {
    one.push_back(seconds_of_equilibrium(host, n, 1));
    many.push_back(seconds_of_equilibrium(host, n, options.threads));
  }
  const double elements = 4.0 * n * n * n;
  report.add(Line()
                 .add("elements", elements)
                 .add("sequential s", median(one))
                 .add("parallel s", median(many))
                 .add("speed-up", median(one) / median(many))
                 .add("us/el", 1e6 * median(many) / elements));
}

void run_scaling(const ScalingOptions& options, Report& report) {
  PluginHost host;
  const Machine &one = machine(1), &many = machine(options.threads);
  report.begin("scaling: the machine",
               "the gain of threads that share nothing: multiply-adds in registers, and a stream "
               "through memory");
  report.add(Line()
                 .add("threads", static_cast<double>(options.threads))
                 .add("GFlop/s, 1", 1e-9 * one.flops)
                 .add("GFlop/s, all", 1e-9 * many.flops)
                 .add("arithmetic speed-up", many.flops / one.flops)
                 .add("GB/s, 1", 1e-9 * one.bandwidth)
                 .add("GB/s, all", 1e-9 * many.bandwidth)
                 .add("memory speed-up", many.bandwidth / one.bandwidth));
  for (const ScalingCase& c : scaling_cases()) {
    report.begin(std::string("scaling: ") + c.name,
                 "beams n x n x 4n of cubes of 0.025 m, whole steps, best of " +
                     std::to_string(options.rounds) + " wall-clock medians, 1 and " +
                     std::to_string(options.threads) + " threads in turn");
    for (const Index n : options.across) measure_beam(c, n, options, host, report);
  }
  report.begin(
      "scaling: static",
      "the cantilever of `static` at a quarter of its weight, equilibria from rest to 1e-8, "
      "medians of up to 3, 1 and " +
          std::to_string(options.threads) + " threads in turn");
  for (const Index n : options.across) measure_equilibrium(n, options, host, report);
}

}  // namespace

void add_scaling(CommandLine& line) {
  auto [command, options] =
      line.add("scaling", "Growing beams, sequential and parallel", run_scaling);
  command.option("--across", &options.across, "Cells over the height; four times that along");
  command.option("--threads", &options.threads, "Threads").positive();
  command.option("--rounds", &options.rounds, "Rounds of each").positive();
  command.option("--seconds", &options.seconds, "Time spent on each figure and round");
}

}  // namespace suture::bench
