// SPDX-License-Identifier: GPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/machine.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/dynamics/newton.hpp"

namespace suture::bench {
namespace {

/// The paper's cantilever at a part of its weight, and the deflections of its tip by independent
/// programs (tests/reference/beam.hpp): of the same trilinear mesh, and converged.
struct Case {
  const char* name;
  double gravity;                   ///< m/s^2
  double discrete[3];               ///< m, of 5x5x20, 10x10x40 and 20x20x80
  double converged = std::nan("");  ///< m; the full load has no converged solution
};
constexpr Index reference_cells[3] = {5, 10, 20};
const Case cases[] = {
    {"A", 9.8, {-0.49929120063264626, -0.5077616632536078, -0.5108246881083}},
    {"A0.25", 2.45, {-0.1467450383566, -0.1498008516107, -0.1507273288824}, -0.15116161849280005},
};

struct Options {
  std::vector<Index> across{5, 10, 20};
  std::vector<std::string> models{"tm-faure"};
};

struct Work {
  unsigned newton = 0, krylov = 0;
};

/// Counts the iterations of a body's steps.
void count_work(BenchBody& body, Work& work) {
  body.dynamics().newton()->on_iteration = [&work](const Newton::Iteration& i) {
    ++work.newton;
    work.krylov += i.linear_iterations;
  };
}

/// Deflection of the centre of the free end, m.
double tip(BenchBody& body, double cell) {
  double sum = 0;
  int count = 0;
  const Column &rest = body.attributes().rest(), &position = body.attributes().position();
  const auto is_central = [&](Index v, int c) {
    return std::abs(rest.get(v, c) - 0.125) < 0.51 * cell;
  };
  for (Index v = 0; v < body.attributes().vertex_count(); ++v) {
    if (rest.get(v, 2) < 1 - 1e-9 || !is_central(v, 0) || !is_central(v, 1)) continue;
    sum += position.get(v, 1) - rest.get(v, 1);
    ++count;
  }
  return sum / count;
}

Line solve(const Case& loading, const std::string& model, Index n, PluginHost& host) {
  const double cell = 0.25 / n;
  BenchBody body(host, {.model = model,
                        .cells = {n, n, 4 * n},
                        .cell = cell,
                        .gravity = {0, -loading.gravity, 0},
                        .integrator = "static",
                        .dt = 1});
  Work work;
  count_work(body, work);
  const double begin = now(1);
  body.step();
  const double seconds = now(1) - begin, deflection = tip(body, cell);
  Line line;
  line.add("case", loading.name)
      .add("model", model)
      .add("elements", static_cast<double>(body.element_count()))
      .add("seconds", seconds)
      .add("us_per_element", 1e6 * seconds / body.element_count())
      .add("newton_steps", static_cast<double>(work.newton))
      .add("krylov_iterations", static_cast<double>(work.krylov))
      .add("tip_m", deflection);
  double discrete = std::nan("");
  for (std::size_t i = 0; i < 3; ++i)
    if (reference_cells[i] == n && model == "tm-faure") discrete = loading.discrete[i];
  line.add("discrete_error", std::abs(deflection / discrete - 1))
      .add("relative_error", std::abs(deflection / loading.converged - 1))
      .add("peak_mb", peak_bytes() / 1e6);
  return line;
}

void run(const Options& options, Report& report) {
  PluginHost host;
  report.begin(
      "static",
      "cantilever of 1 m under its weight (E 400 kPa, nu 0.3, rho 1000) from rest to 1e-8, "
      "after the mesh is read and the body built; CPU s of one thread");
  for (const Case& loading : cases)
    for (const std::string& model : options.models)
      for (const Index n : options.across) report.add(solve(loading, model, n, host));
}

struct ImplicitOptions {
  std::vector<Index> across{5, 10};
  std::vector<std::string> integrators{"implicit-euler", "newmark"};
  double dt = 1.0 / 60;
  int steps = 30;
};

void run_implicit(const ImplicitOptions& options, Report& report) {
  PluginHost host;
  report.begin("implicit", "the same cantilever at A0.25, let go at rest, tm-faure; CPU s");
  for (const std::string& integrator : options.integrators)
    for (const Index n : options.across) {
      BenchBody body(host, {.model = "tm-faure",
                            .cells = {n, n, 4 * n},
                            .cell = 0.25 / n,
                            .gravity = {0, -2.45, 0},
                            .integrator = integrator,
                            .dt = options.dt});
      Work work;
      count_work(body, work);
      const double begin = now(1);
      for (int i = 0; i < options.steps; ++i) body.step();
      const double seconds = (now(1) - begin) / options.steps;
      report.add(Line()
                     .add("integrator", integrator)
                     .add("elements", static_cast<double>(body.element_count()))
                     .add("dt_s", options.dt)
                     .add("ms_per_step", 1e3 * seconds)
                     .add("us_per_element", 1e6 * seconds / body.element_count())
                     .add("newton_steps", work.newton / static_cast<double>(options.steps))
                     .add("krylov_iterations", work.krylov / static_cast<double>(options.steps)));
    }
}

}  // namespace

void add_static(CLI::App& app, std::vector<Command>& commands) {
  auto* command = app.add_subcommand("static", "Time, iterations and error of static equilibria");
  auto options = std::make_shared<Options>();
  command->add_option("--across", options->across, "Cells over the height; four times that along");
  command->add_option("--models", options->models, "Models with the parameters E, nu and rho");
  commands.push_back({command, [options](Report& report) { run(*options, report); }});
}

void add_implicit(CLI::App& app, std::vector<Command>& commands) {
  auto* command = app.add_subcommand("implicit", "Time and iterations of implicit steps");
  auto options = std::make_shared<ImplicitOptions>();
  command->add_option("--across", options->across, "Cells over the height; four times that along");
  command->add_option("--integrators", options->integrators, "Names as in scenes");
  command->add_option("--dt", options->dt, "s");
  command->add_option("--steps", options->steps, "Number of steps");
  commands.push_back({command, [options](Report& report) { run_implicit(*options, report); }});
}

}  // namespace suture::bench
