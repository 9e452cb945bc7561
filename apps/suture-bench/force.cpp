// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <string>
#include <vector>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/machine.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/base/error.hpp"

namespace suture::bench {
namespace {

struct ForceCase {
  const char* name;
  const char* model;
  std::map<std::string, double> parameters;
  bool distorted;
  bool springs;  // count springs too
  /// Operations per element (a multiply-add is two), counted in the machine code of
  /// the AVX-512 plugin; 0: not counted. 3 edges per element.
  double operations;
};

/// Moduli near those of the paper's material; fibres along the space diagonal.
std::map<std::string, double> with_element(std::map<std::string, double> values, double element) {
  values["element"] = element;
  return values;
}
const std::map<std::string, double> of_mooney{{"C10", 5e4}, {"C01", 2.7e4}, {"K", 3.3e5}},
    of_fibres{{"mu", 1.5e5}, {"lambda", 2.3e5}, {"k1", 1e5}, {"k2", 1}, {"fibre", 0.577}},
    of_visco{{"K", 1e5}, {"n", 0.1}, {"lambda", 2.3e5}};

const std::vector<ForceCase>& force_cases() {
  static const std::vector<ForceCase> list{
      {"TM boxes, gauss2", "tm-faure", {}, false, false, 1142},
      {"TM boxes, exact", "tm-faure", {{"quadrature", 1}}, false, false, 0},
      {"TM boxes, mean gradient", "tm-faure", {{"element", 1}}, false, false, 0},
      {"TM general, gauss2", "tm-faure", {}, true, false, 0},
      {"TM general, gauss2, geometry recomputed", "tm-faure", {{"geometry", 1}}, true, false, 2504},
      {"TM general, mean gradient", "tm-faure", {{"element", 1}}, true, false, 0},
      {"neo-Hookean boxes, gauss2", "neo-hookean", {{"element", 0}}, false, false, 0},
      {"neo-Hookean boxes, mean gradient", "neo-hookean", {}, false, false, 0},
      {"Mooney-Rivlin boxes, gauss2", "mooney-rivlin", with_element(of_mooney, 0), false, false, 0},
      {"Mooney-Rivlin boxes, mean gradient", "mooney-rivlin", of_mooney, false, false, 0},
      {"fibres, boxes, gauss2", "fibres", with_element(of_fibres, 0), false, false, 0},
      {"fibres, boxes, mean gradient", "fibres", of_fibres, false, false, 0},
      {"corotational boxes, gauss2", "corotational", {{"element", 0}}, false, false, 0},
      {"corotational boxes, mean gradient", "corotational", {}, false, false, 0},
      {"viscous boxes, gauss2", "visco", with_element(of_visco, 0), false, false, 0},
      {"viscous boxes, mean gradient", "visco", of_visco, false, false, 0},
      {"MSS undamped", "mss-baudet", {}, false, true, 196},
      {"MSS, viscosity", "mss-baudet", {{"viscosity", 1}}, false, true, 0},
      {"MSS, correction", "mss-baudet", {{"correction", 1}}, false, true, 0},
      {"MSS with face diagonals", "mss-golec", {}, false, false, 0},
  };
  return list;
}

struct ForceOptions {
  std::vector<Index> sizes{1000, 4000, 32000, 432000, 4000000};
  std::string only;
  unsigned threads = 1, cuts = 1000;
  double seconds = 0.5;
};

/// Springs of a step: edges, and four inner ones per element.
double springs(BenchBody& body) { return body.complex().count(1) + 4.0 * body.element_count(); }

/// Beside the two roofs of the machine: bytes that must move if no cache helps (so
/// more than the whole stream is possible), and operations. Throws NumericalError if a model is
/// faster than the processor was found to be.
void add_roofline(const ForceCase& c, BenchBody& body, double seconds, unsigned threads,
                  Line& line) {
  const Machine& roof = machine(threads);
  const double bytes = bytes_per_element(body), rate = body.element_count() / seconds;
  line.add("B/el", bytes).add("% of stream", 100 * bytes * rate / roof.bandwidth);
  if (c.operations == 0) return;
  const double share = c.operations * rate / roof.flops;
  if (share > 1)
    throw NumericalError(
        std::string(c.name) + " takes " + std::to_string(share) +
        " times the peak of this processor: the peak (machine.cpp) was measured wrongly");
  line.add("flop/el", c.operations).add("% of peak", 100 * share);
}

void measure_force(const ForceCase& c, Index size, const ForceOptions& options, PluginHost& host,
                   Report& report) {
  BenchBody body(host, {.model = c.model,
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
  const auto force = [&] { body.body().models().add_forces(0, 0); };
  const Timing forces = measure(force, options.threads, options.seconds);
  line.add("force M el/s", rate(forces, elements));
  add_roofline(c, body, forces.median, options.threads, line);
  Column& sums = body.attributes().force();
  std::fill(sums.rows(), sums.rows() + std::size_t{sums.size()} * 4, 0.0);
  if (options.cuts != 0 && elements > 4 * options.cuts) {
    line.add("us/cut", 1e6 * body.cut_random(options.cuts, 1) / options.cuts);
    const Timing cut = measure(step, options.threads, options.seconds);
    line.add("cut M el/s", rate(cut, elements)).add("cut/fresh", cut.median / fresh.median);
  }
  report.add(std::move(line));
}

void add_roofs(unsigned threads, Report& report) {
  const Machine& roof = machine(threads);
  report.begin("force: roofline",
               "measured on this machine: multiply-adds in registers, and a[i] = b[i] + s c[i] "
               "through memory (24 B each); " +
                   std::to_string(threads) + " thread(s)");
  report.add(Line()
                 .add("GFlop/s", 1e-9 * roof.flops)
                 .add("GB/s", 1e-9 * roof.bandwidth)
                 .add("flop/B at the ridge", roof.flops / roof.bandwidth));
}

void run_force(const ForceOptions& options, Report& report) {
  PluginHost host;
  add_roofs(options.threads, report);
  for (const ForceCase& c : force_cases()) {
    if (std::string(c.name).find(options.only) == std::string::npos) continue;
    report.begin(c.name, "whole steps of symplectic Euler with gravity and one end fixed, " +
                             std::to_string(options.threads) + " thread(s), medians");
    for (const Index size : options.sizes) measure_force(c, size, options, host, report);
  }
}

}  // namespace

void add_force(CommandLine& line) {
  auto [command, options] =
      line.add("force", "Throughput of the models through the SDK, by size", run_force);
  command.option("--sizes", &options.sizes, "Elements (432000: the 60x60x120 grid)");
  command.option("--only", &options.only, "Cases whose name contains this");
  command.option("--threads", &options.threads, "Threads").positive();
  command.option("--cuts", &options.cuts, "Random cuts of one face; 0: none");
  command.option("--seconds", &options.seconds, "Time spent on each figure");
}

}  // namespace suture::bench
