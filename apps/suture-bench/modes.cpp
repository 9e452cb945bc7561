// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/machine.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/spectrum/natural_modes.hpp"

namespace suture::bench {
namespace {

struct ModeOptions {
  std::vector<Index> across{5, 10, 20};
  std::vector<std::string> models{"tm-faure"};
  unsigned count = 10;
};

Line find(const std::string& model, Index n, unsigned count, PluginHost& host) {
  BenchBody body(host, {.model = model, .cells = {n, n, 4 * n}, .cell = 0.25 / n});
  const double begin = now(1);
  const NaturalModes found = find_natural_modes(body.body(), 0, count);
  const double seconds = now(1) - begin;
  double residual = 0;
  for (const NaturalMode& mode : found.modes) residual = std::max(residual, mode.residual);
  const auto frequency = [](const NaturalMode& mode) {
    return mode.kind == NaturalMode::Kind::vibration ? mode.frequency() : 0;
  };
  return Line()
      .add("model", model)
      .add("elements", static_cast<double>(body.element_count()))
      .add("count", static_cast<double>(count))
      .add("seconds", seconds)
      .add("us_per_element", 1e6 * seconds / body.element_count())
      .add("iterations", static_cast<double>(found.iterations))
      .add("products", static_cast<double>(found.products))
      .add("residual", residual)
      .add("first_hz", frequency(found.modes.front()))
      .add("last_hz", frequency(found.modes.back()))
      .add("peak_mb", peak_bytes() / 1e6);
}

void run_modes(const ModeOptions& options, Report& report) {
  PluginHost host;
  report.begin("modes",
               "lowest natural modes of the cantilever of 1 m at rest (E 400 kPa, nu 0.3, rho "
               "1000), one end held; the largest residual, whose square is about the relative "
               "error of omega^2; CPU s of one thread");
  for (const std::string& model : options.models)
    for (const Index n : options.across) report.add(find(model, n, options.count, host));
}

}  // namespace

void add_modes(CommandLine& line) {
  auto [command, options] =
      line.add("modes", "Natural modes: time, iterations and residuals", run_modes);
  command.option("--across", &options.across, "Cells over the height; four times that along");
  command.option("--models", &options.models, "Models with the parameters E, nu and rho");
  command.option("--count", &options.count, "Number of modes").positive();
}

}  // namespace suture::bench
