// SPDX-License-Identifier: GPL-3.0-or-later
//
// Error against run time: whole processes of `suture run`, with CalculiX beside them where it is
// installed, compared with solutions of other programs.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/suture-bench/calculix.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/process.hpp"
#include "apps/suture-bench/work_cases.hpp"
#include "kernel/base/error.hpp"

namespace suture::bench {
namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

struct WorkOptions {
  std::vector<std::string> cases;  ///< none: all
  bool largest = false, beside = true;
  int rounds = 5;
  double most_dofs = std::numeric_limits<double>::infinity();
  double budget = 1;  ///< CPU s after which a row is not repeated
};

struct WorkRow {
  std::string problem, program, method, mesh;
  double dofs = 0, cpu = 0, wall = 0, error = no_value;
  std::string note{};
  bool on_front = false;

  Line line() const {
    return Line()
        .add("case", problem)
        .add("program", program)
        .add("method", method)
        .add("mesh", mesh)
        .add("dofs", dofs)
        .add("cpu_s", cpu)
        .add("wall_s", wall)
        .add("relative_error", error)
        .add("front", std::string(on_front ? "*" : ""))
        .add("note", note);
  }
};

/// Nothing else in the case is both faster and more accurate.
void mark_front(std::vector<WorkRow>& rows) {
  std::vector<WorkRow*> sorted;
  for (WorkRow& row : rows)
    if (std::isfinite(row.error)) sorted.push_back(&row);
  std::ranges::sort(sorted, {}, &WorkRow::cpu);
  double least = std::numeric_limits<double>::infinity();
  for (WorkRow* row : sorted) {
    row->on_front = std::abs(row->error) < least;
    least = std::min(least, std::abs(row->error));
  }
}

/// The value of a column in the last row of a table.
double last_value(const std::filesystem::path& file, const std::string& column) {
  std::ifstream table(file);
  std::string head, line, last;
  std::getline(table, head);
  while (std::getline(table, line)) last = line;
  std::istringstream names(head), values(last);
  for (std::string name, value; std::getline(names, name, ',') && std::getline(values, value, ',');)
    if (name == column) return std::stod(value);
  throw IoError(file.string() + " has no value of '" + column + "'");
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

/// Median times of a process that is repeated while that is cheap; `run` returns its cpu and wall.
template <class Run>
void repeat(const WorkOptions& options, WorkRow& row, Run run) {
  std::vector<double> cpu, wall;
  double total = 0;
  do {
    const auto [c, w] = run();
    cpu.push_back(c);
    wall.push_back(w);
    total += c;
  } while (static_cast<int>(cpu.size()) < options.rounds && total < options.budget);
  row.cpu = median(cpu);
  row.wall = median(wall);
}

WorkRow run_suture(const WorkOptions& options, const WorkCase& what, const WorkMethod& method,
                   const WorkMesh& mesh) {
  const WorkingFolder folder;
  std::ofstream(folder.path() / "scene.json") << what.scene(mesh, method).dump(1) << '\n';
  WorkRow row{what.name, "Suture", method.name, mesh.name(), mesh.dofs()};
  int code = 0;
  repeat(options, row, [&] {
    const ProcessUse use = run_process(
        {suture_program(), "run", "-q", "scene.json", "--output", "out"}, folder.path());
    code = use.code;
    return std::pair{use.cpu, use.wall};
  });
  if (code != 0) row.note = "stopped, exit code " + std::to_string(code);
  if (code == 5) row.note = "no stable equilibrium (exit code 5)";
  if (code == 0)
    row.error =
        what.scale * last_value(folder.path() / "out/probes.csv", what.column) / what.reference - 1;
  return row;
}

WorkRow run_ccx(const WorkOptions& options, const WorkCase& what, const CalculixJob& job) {
  const WorkMesh mesh{job.cells, job.grading};
  WorkRow row{what.name, "CalculiX", job.element + " " + job.solver, mesh.name(), mesh.dofs()};
  if (job.element == "C3D20R") {
    const double x = job.cells[0], y = job.cells[1], z = job.cells[2];  // and the middles of edges
    row.dofs += 3 * (x * (y + 1) * (z + 1) + (x + 1) * y * (z + 1) + (x + 1) * (y + 1) * z);
  }
  try {
    repeat(options, row, [&] {
      const CalculixRun found = run_calculix(cantilever(what.cantilever), job);
      row.error = found.tip / what.reference - 1;
      return std::pair{found.seconds, found.wall};
    });
  } catch (const IoError& error) {
    row.note = error.what();
  }
  return row;
}

/// The elements and solvers of the front of 2026-11-21, and the graded meshes of Suture.
std::vector<CalculixJob> calculix_jobs(bool largest) {
  std::vector<CalculixJob> jobs;
  const auto add = [&](const char* element, const char* solver, std::vector<Index> sections) {
    for (const Index n : sections) jobs.push_back({element, {4 * n, n, n}, 1, solver});
  };
  add("C3D8", "SPOOLES", {3, 5, 8, 10});
  add("C3D8I", "SPOOLES", {1, 2, 3, 5, 8, 10});
  add("C3D20R", "SPOOLES", {1, 2, 3, 4, 5, 6});
  add("C3D8", "ITERATIVE CHOLESKY", {10, 14});
  add("C3D8I", "ITERATIVE CHOLESKY", {10});
  add("C3D20R", "ITERATIVE CHOLESKY", {5});
  if (largest) {
    add("C3D8", "ITERATIVE CHOLESKY", {20});
    add("C3D8I", "ITERATIVE CHOLESKY", {14, 20});
    add("C3D20R", "ITERATIVE CHOLESKY", {6, 8});
  }
  for (const char* element : {"C3D8I", "C3D20R"}) {
    jobs.push_back({element, {9, 3, 3}, 8});
    jobs.push_back({element, {12, 4, 4}, 8});
    jobs.push_back({element, {24, 6, 6}, 16});
  }
  return jobs;
}

void run_case(const WorkOptions& options, const WorkCase& what, Report& report) {
  report.begin(what.name, "relative to " + std::to_string(what.reference) + ": " + what.source);
  std::vector<WorkRow> rows;
  const auto show = [](const WorkRow& row) {
    std::printf("%s, %s, %s: %.4g s, %.3g %%  %s\n", row.program.c_str(), row.method.c_str(),
                row.mesh.c_str(), row.cpu, 100 * row.error, row.note.c_str());
    std::fflush(stdout);
  };
  for (const WorkMethod& method : what.methods)
    for (const WorkMesh& mesh : method.meshes)
      if (mesh.dofs() <= options.most_dofs)
        show(rows.emplace_back(run_suture(options, what, method, mesh)));
  if (options.beside && has_calculix() && !what.cantilever.empty())
    for (const CalculixJob& job : calculix_jobs(options.largest))
      if (WorkMesh{job.cells}.dofs() <= options.most_dofs)
        show(rows.emplace_back(run_ccx(options, what, job)));
  mark_front(rows);
  for (const WorkRow& row : rows) report.add(row.line());
}

void run_work(const WorkOptions& options, Report& report) {
  if (options.beside && !has_calculix())
    std::printf("CalculiX (ccx) is not installed: its rows are left out\n");
  for (const WorkCase& what : work_cases(options.largest))
    if (options.cases.empty() || std::ranges::count(options.cases, what.name) > 0)
      run_case(options, what, report);
}

}  // namespace

void add_work_precision(CLI::App& app, std::vector<Command>& commands) {
  auto* command = app.add_subcommand("work-precision", "Error against run time of whole processes");
  auto options = std::make_shared<WorkOptions>();
  std::vector<std::string> names;
  for (const WorkCase& known : work_cases(false)) names.push_back(known.name);
  command->add_option("--cases", options->cases, "Problems; default: all")
      ->check(CLI::IsMember(names));
  command->add_flag("--largest", options->largest, "With meshes that take longer than 5 s");
  command->add_flag("!--no-calculix", options->beside, "Leave out CalculiX");
  command->add_option("--dofs", options->most_dofs, "Largest number of unknowns of a mesh")
      ->check(CLI::PositiveNumber);
  command->add_option("--rounds", options->rounds, "Repetitions")->check(CLI::PositiveNumber);
  commands.push_back({command, [options](Report& report) { run_work(*options, report); }});
}

}  // namespace suture::bench
