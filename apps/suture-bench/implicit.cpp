// SPDX-License-Identifier: GPL-3.0-or-later

#include <algorithm>

#include "apps/suture-bench/cantilever.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/machine.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/implicit/newton.hpp"

namespace suture::bench {
namespace {

struct ImplicitOptions {
  std::vector<Index> across{5, 10};
  std::vector<std::string> models{"tm-faure"}, elements{"trilinear", "mean-gradient"},
      integrators{"implicit-euler", "newmark"};
  double dt = 1.0 / 60, budget_ms = 10;
  int steps = 30, budgeted_steps = 1000;
};

/// What is asked of a step of 1/60 s of 4,000 trilinear elements.
constexpr double asked_ms = 15;

bool is_asked(const std::string& integrator, Index across, const CantileverMesh& mesh, double dt) {
  return integrator == "implicit-euler" && across == 10 && mesh.element == "trilinear" &&
         dt == 1.0 / 60;
}

/// The tip of 5x5x20 trilinear elements after 0.5 s by an independent program (case I of
/// tests/reference/beam.hpp), m; NaN for other meshes and times.
double reference_tip(const CantileverMesh& mesh, const ImplicitOptions& options) {
  const bool is_known = mesh.across == 5 && mesh.element == "trilinear" &&
                        std::abs(options.steps * options.dt - 0.5) < 1e-9;
  return is_known ? -0.2651348698621649 : std::nan("");
}

Line measure_steps(const std::string& integrator, const suture_model& model,
                   const CantileverMesh& mesh, const ImplicitOptions& options, PluginHost& host) {
  forget_peak();
  const Cantilever& what = cantilever("A0.25");
  BodyOptions of_body = options_of(what, model, mesh);
  of_body.integrator = integrator;
  of_body.dt = options.dt;
  BenchBody body(host, of_body);
  const Work work(body.dynamics());
  const double begin = now(1);
  for (int i = 0; i < options.steps; ++i) body.step();
  const double seconds = (now(1) - begin) / options.steps;
  Line line;
  line.add("case", what.name + ", " + integrator)
      .add("model", model.id)
      .add("element", mesh.element)
      .add("elements", static_cast<double>(body.element_count()))
      .add("dt_s", options.dt)
      .add("ms_per_step", 1e3 * seconds)
      .add("asked_ms",
           is_asked(integrator, mesh.across, mesh, options.dt) ? asked_ms : std::nan(""))
      .add("us_per_element", 1e6 * seconds / body.element_count())
      .add("newton_steps", work.newton / options.steps)
      .add("krylov_iterations", work.krylov / options.steps)
      .add("builds", static_cast<double>(body.dynamics().newton()->builds()) / options.steps)
      .add("relative_error", std::abs(tip_of(body, mesh.across) / reference_tip(mesh, options) - 1))
      .add("peak_mb", peak_bytes() / 1e6);
  return line;
}

/// Steps that are on time instead of solved, until the damped body rests.
Line measure_budget(const suture_model& model, const CantileverMesh& mesh,
                    const ImplicitOptions& options, PluginHost& host) {
  const double ms = options.budget_ms;
  const Cantilever& what = cantilever("A0.25");
  BodyOptions of_body = options_of(what, model, mesh);
  of_body.integrator = "implicit-euler";
  of_body.dt = options.dt;
  of_body.damping = 2;
  of_body.solver.budget = StepBudget{0, ms / 1000};
  BenchBody body(host, of_body);
  body.dynamics().prepare(of_body.dt);
  std::vector<double> walls;
  for (int i = 0; i < options.budgeted_steps; ++i) {
    const double start = wall();
    body.step();
    walls.push_back(1e3 * (wall() - start));
  }
  return Line()
      .add("case", what.name + ", damping 2/s")
      .add("model", model.id)
      .add("element", mesh.element)
      .add("elements", static_cast<double>(body.element_count()))
      .add("budget_ms", ms)
      .add("steps", static_cast<double>(options.budgeted_steps))
      .add("late", static_cast<double>(
                       std::ranges::count_if(walls, [ms](double wall) { return wall > ms; })))
      .add("worst_ms", *std::ranges::max_element(walls))
      .add("median_ms", median(walls))
      .add("builds", static_cast<double>(body.dynamics().newton()->builds()))
      .add("rest_error_%",
           100 * (std::abs(tip_of(body, mesh.across) / what.discrete_tip(mesh.across)) - 1));
}

void run_implicit(const ImplicitOptions& options, Report& report) {
  PluginHost host;
  report.begin("implicit",
               "the cantilever of `static` at a quarter of its weight, let go at rest: CPU s and "
               "iterations per step, one thread");
  for (const std::string& integrator : options.integrators)
    for (const std::string& model : options.models)
      for (const std::string& element : options.elements)
        for (const Index n : options.across)
          report.add(measure_steps(integrator, host.model(model), {n, element}, options, host));
  if (options.budgeted_steps == 0) return;
  report.begin("implicit, on a budget",
               "the same with damping, and implicit Euler with a budget of the wall clock for each "
               "step: how many steps were late, and how far the tip is from rest in the end");
  for (const std::string& model : options.models)
    for (const Index n : options.across)
      report.add(measure_budget(host.model(model), {n, "trilinear"}, options, host));
}

}  // namespace

void add_implicit(CommandLine& line) {
  auto [command, options] =
      line.add("implicit", "Time and iterations of implicit steps", run_implicit);
  command.option("--across", &options.across, "Cells over the height; four times that along");
  command.option("--models", &options.models, "Models with the parameters E, nu and rho");
  command.option("--elements", &options.elements, "Element types of the models");
  command.option("--integrators", &options.integrators, "Names as in scenes");
  command.option("--dt", &options.dt, "s").positive();
  command.option("--steps", &options.steps, "Number of steps").positive();
  command.option("--budget", &options.budget_ms, "ms for each step on a budget").positive();
  command.option("--budgeted-steps", &options.budgeted_steps, "Number of these; 0: none");
}

}  // namespace suture::bench
