// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/timer.hpp"

namespace suture::bench {
namespace {

struct Case {
  const char* name;
  const char* model;
  std::map<std::string, double> parameters;
  bool distorted;
  bool springs;  // count springs too
};

const std::vector<Case>& cases() {
  static const std::vector<Case> list{
      {"TM boxes, gauss2", "tm-faure", {}, false, false},
      {"TM boxes, exact", "tm-faure", {{"quadrature", 1}}, false, false},
      {"TM general, gauss2", "tm-faure", {}, true, false},
      {"TM general, gauss2, geometry recomputed", "tm-faure", {{"geometry", 1}}, true, false},
      {"MSS undamped", "mss-baudet", {}, false, true},
      {"MSS, viscosity", "mss-baudet", {{"viscosity", 1}}, false, true},
      {"MSS, correction", "mss-baudet", {{"correction", 1}}, false, true},
  };
  return list;
}

struct Options {
  std::vector<Index> sizes{4000, 32000, 432000};
  std::string only;
  unsigned threads = 1, cuts = 1000;
  double seconds = 0.5;
};

/// Springs of a step: edges, and four inner ones per element.
double springs(const Body& body) { return body.complex().count(1) + 4.0 * body.element_count(); }

void measure_case(const Case& c, Index size, const Options& options, PluginHost& host,
                  Report& report) {
  Body body(host, {.model = c.model,
                   .parameters = c.parameters,
                   .cells = grid_of(size),
                   .distorted = c.distorted,
                   .threads = options.threads});
  const double elements = body.element_count();
  const auto rate = [&](const Timing& t, double count) { return 1e-6 * count / t.median; };
  const auto step = [&] { body.step(); };
  const Timing fresh = measure(step, options.threads, options.seconds);
  const double fresh_springs = c.springs ? springs(body) : 0;
  Line line;
  line.add("case", std::string(c.name)).add("elements", elements);
  line.add("step M el/s", rate(fresh, elements));
  if (c.springs) line.add("M springs/s", rate(fresh, fresh_springs));
  line.add("ns/el", 1e9 * fresh.median / elements);
  const auto force = [&] { body.dynamics().forces().add_forces(0, 0); };
  line.add("force M el/s", rate(measure(force, options.threads, options.seconds), elements));
  Column& sums = body.attributes().force();
  std::fill(sums.rows(), sums.rows() + std::size_t{sums.size()} * 4, 0.0);
  if (options.cuts != 0 && elements > 4 * options.cuts) {
    line.add("us/cut", 1e6 * body.cut_random(options.cuts, 1) / options.cuts);
    const Timing cut = measure(step, options.threads, options.seconds);
    line.add("cut M el/s", rate(cut, elements)).add("cut/fresh", cut.median / fresh.median);
  }
  report.add(std::move(line));
}

void run(const Options& options, Report& report) {
  PluginHost host;
  for (const Case& c : cases()) {
    if (std::string(c.name).find(options.only) == std::string::npos) continue;
    report.begin(c.name, "whole steps of symplectic Euler with gravity and a held end, " +
                             std::to_string(options.threads) + " thread(s), medians");
    for (const Index size : options.sizes) measure_case(c, size, options, host, report);
  }
}

}  // namespace

void add_force(CLI::App& app, std::vector<Command>& commands) {
  auto* command = app.add_subcommand("force", "Rates of the models through the SDK, by size");
  auto options = std::make_shared<Options>();
  command->add_option("--sizes", options->sizes, "Elements (432000: the 60x60x120 grid)");
  command->add_option("--only", options->only, "Cases whose name contains this");
  command->add_option("--threads", options->threads, "Threads")->check(CLI::PositiveNumber);
  command->add_option("--cuts", options->cuts, "Random cuts of one face; 0: none");
  command->add_option("--seconds", options->seconds, "Time spent on each figure");
  commands.push_back({command, [options](Report& report) { run(*options, report); }});
}

}  // namespace suture::bench
