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

void run_step(const StepOptions& options, Report& report) {
  PluginHost host;
  for (const std::string& model : options.models) {
    report.begin("step " + model, "where the time of a step goes, best of 5 medians, " +
                                      std::to_string(options.threads) +
                                      " thread(s); checks are not part of every step");
    for (const Index size : options.sizes) measure_model(model, size, options, host, report);
  }
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
