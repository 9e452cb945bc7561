// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/dynamics/inversion.hpp"

namespace suture::bench {
namespace {

struct StepOptions {
  std::vector<Index> sizes{500, 4000, 32000, 432000, 4000000};
  std::vector<std::string> models{"tm-faure", "mss-baudet"};
  unsigned threads = 1;
  double seconds = 0.5;
};

/// Step and force alternate, so that a slow moment of the machine hits both.
void measure_model(const std::string& model, Index size, const StepOptions& options,
                   PluginHost& host, Report& report) {
  BenchBody body(host, {.model = model, .cells = grid_of(size), .threads = options.threads});
  const double ns = 1e9 / body.element_count();
  double step = 1e9, force = 1e9, energy = 1e9, inversions = 1e9;
  const double part = options.seconds / 5;
  for (int round = 0; round < 5; ++round) {
    step = std::min(step, measure([&] { body.step(); }, options.threads, part).median);
    force = std::min(
        force,
        measure([&] { body.body().models().add_forces(0, 0); }, options.threads, part).median);
    Column& sums = body.attributes().force();
    std::fill(sums.rows(), sums.rows() + std::size_t{sums.size()} * 4, 0.0);
  }
  energy = measure([&] { body.body().models().energy(0); }, options.threads, part).median;
  const double cpu = now(1);
  const double dt = body.limits().stable_step(0);
  const double search = now(1) - cpu;
  const double again = measure([&] { body.limits().stable_step(0); }, options.threads, part).median;
  const double bound = body.limits().bounds(0).dt;
  inversions =
      measure([&] { find_inverted(body.complex(), body.attributes()); }, options.threads, part)
          .median;
  report.add(Line()
                 .add("elements", static_cast<double>(body.element_count()))
                 .add("step ns/el", ns * step)
                 .add("force ns/el", ns * force)
                 .add("step/force", step / force)
                 .add("energy ns/el", ns * energy)
                 .add("first dt/force", search / force)
                 .add("next dt/force", again / force)
                 .add("dt s", dt)
                 .add("bound/dt", bound / dt)
                 .add("inversion ns/el", ns * inversions));
}

/// A phase field that moves with its law, beside a law alone. Its viscosity is such that it has one
/// step in each of the motion. Steps of both alternate.
void measure_fields(double element, Index size, const StepOptions& options, PluginHost& host,
                    Report& report) {
  const auto body = [&](const char* model, std::map<std::string, double> parameters) {
    parameters["K"] = 3.3e5;
    parameters["element"] = element;
    return BenchBody(host, {.model = model,
                            .parameters = parameters,
                            .cells = grid_of(size),
                            .threads = options.threads});
  };
  BenchBody alone = body("mooney-rivlin", {{"C10", 5e4}, {"C01", 2.7e4}});
  BenchBody coupled =
      body("gradient-damage", {{"mu", 1.54e5}, {"Gc", 1e4}, {"l", 0.05}, {"eta", 1e4}});
  double law = 1e9, both = 1e9;
  for (int round = 0; round < 5; ++round) {
    const double part = options.seconds / 5;
    law = std::min(law, measure([&] { alone.step(); }, options.threads, part).median);
    both = std::min(both, measure([&] { coupled.step(); }, options.threads, part).median);
  }
  const double millions = 1e-6 * alone.element_count();
  report.add(Line()
                 .add("element", std::string(element == 0 ? "trilinear" : "mean gradient"))
                 .add("elements", 1e6 * millions)
                 .add("law M el/s", millions / law)
                 .add("with field M el/s", millions / both)
                 .add("speed", law / both));
}

void run_step(const StepOptions& options, Report& report) {
  PluginHost host;
  for (const std::string& model : options.models) {
    report.begin("step " + model, "where the time of a step goes, best of 5 medians, " +
                                      std::to_string(options.threads) +
                                      " thread(s); checks are not part of every step");
    for (const Index size : options.sizes) measure_model(model, size, options, host, report);
  }
  report.begin("step: fields",
               "gradient-damage, which has a field, beside mooney-rivlin, best of 5 "
               "medians, " +
                   std::to_string(options.threads) + " thread(s)");
  for (const double element : {0, 1})
    for (const Index size : options.sizes)
      if (size <= 432000) measure_fields(element, size, options, host, report);
}

}  // namespace

void add_step(CommandLine& line) {
  auto [command, options] = line.add("step", "Where the time of a step goes", run_step);
  command.option("--sizes", &options.sizes, "Elements (432000: the 60x60x120 grid)");
  command.option("--models", &options.models, "Models");
  command.option("--threads", &options.threads, "Threads").positive();
  command.option("--seconds", &options.seconds, "Time spent on each figure");
}

}  // namespace suture::bench
