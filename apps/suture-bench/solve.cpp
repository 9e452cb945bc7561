// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <random>

#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/solve_case.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/solvers/block_jacobi.hpp"
#include "kernel/solvers/conjugate_gradients.hpp"
#include "kernel/solvers/direct.hpp"
#include "kernel/solvers/multigrid.hpp"

namespace suture::bench {
namespace {

struct SolveOptions {
  std::vector<Index> across{10};
  std::vector<std::string> cases, files;
  double tolerance = 1e-8;
  unsigned smoothing = 2;
  double dt = 0;
  bool reference = true, direct = false;
};

/// Weight along -y, N.
std::vector<double> load_of(const TangentMatrix& a, Body& body) {
  std::vector<double> b(a.size());
  for (Index v = 0; v < b.size() / 3; ++v)
    b[std::size_t{v} * 3 + 1] = -9.8 * body.attributes().mass().get(v, 0);
  a.restrict(b);
  return b;
}

void solve(const std::string& name, Preconditioner& preconditioner, const TangentMatrix& a,
           std::span<const double> b, double elements, const SolveOptions& options,
           Report& report) {
  std::vector<double> x(b.size());
  const double start = now(1);
  preconditioner.build(a);
  const double built = now(1);
  preconditioner.build(a);
  const double rebuilt = now(1);
  const LinearSolve result =
      ConjugateGradients().solve(a, preconditioner, b, x, options.tolerance, 5000);
  const double done = now(1);
  report.add(Line()
                 .add("case", name)
                 .add("solver", preconditioner.name())
                 .add("elements", elements)
                 .add("set-up s", built - start)
                 .add("again s", rebuilt - built)
                 .add("iterations", static_cast<double>(result.iterations))
                 .add("ok", result.outcome == LinearSolve::Outcome::converged ? 1. : 0.)
                 .add("solve s", done - rebuilt)
                 .add("us/el", (done - rebuilt) / elements * 1e6)
                 .add("bytes/el", static_cast<double>(preconditioner.bytes()) / elements));
}

void measure_solvers(const SolveCase& what, const SolveOptions& options, PluginHost& host,
                     Report& report) {
  const auto body = body_of(what, host);
  TangentMatrix a(body->attributes(), body->terms(), body->models().workers());
  a.set(0, options.dt > 0 ? 1 / (options.dt * options.dt) : 0);
  const std::vector<double> b = load_of(a, *body);
  const auto elements = static_cast<double>(body->complex().existing(3));
  const auto multigrid =
      make_multigrid(body->complex(), body->attributes(), {.smoothing = options.smoothing});
  solve(what.name, *multigrid, a, b, elements, options, report);
  if (options.direct)
    solve(what.name, *make_direct(body->complex(), body->attributes()), a, b, elements, options,
          report);
  if (options.reference) solve(what.name, *make_block_jacobi(), a, b, elements, options, report);
}

bool is_wanted(const SolveCase& what, const SolveOptions& options) {
  return options.cases.empty() || std::ranges::count(options.cases, what.name) > 0;
}

void run_solve(const SolveOptions& options, Report& report) {
  PluginHost host;
  report.begin("solve",
               "one linear solve at rest under weight, one thread; the set-up twice: hierarchy and "
               "operators, operators alone");
  for (const Index n : options.across)
    for (const SolveCase& what : solve_cases(n))
      if (is_wanted(what, options)) measure_solvers(what, options, host, report);
  for (const std::string& file : options.files)
    measure_solvers(case_of_file(file), options, host, report);
}

}  // namespace

void add_solve(CommandLine& line) {
  auto [command, options] =
      line.add("solve", "Linear solvers: set-up, iterations and time", run_solve);
  command.option("--across", &options.across, "Cells across; about 4 n^3 elements");
  command.option("--cases", &options.cases, "Names of cases; none: all");
  command.option("--files", &options.files, "Meshes, held at their lowest tenth along z");
  command.option("--tolerance", &options.tolerance, "Residual relative to the load");
  command.option("--smoothing", &options.smoothing, "Smoothing steps of the multigrid");
  command.option("--dt", &options.dt, "Adds the mass term of implicit Euler, s");
  command.flag("--direct", &options.direct, "The direct solver, too");
  command.flag("!--no-reference", &options.reference, "Leave out block Jacobi");
}

}  // namespace suture::bench
