// SPDX-License-Identifier: GPL-3.0-or-later
//
// Error against run time: whole processes of `suture run`, with CalculiX beside them where it is
// installed, compared with solutions of other programs.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/suture-bench/calculix.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/process.hpp"
#include "apps/suture-bench/timer.hpp"
#include "apps/suture-bench/work_cases.hpp"
#include "kernel/base/error.hpp"
#include "kernel/mesh/mesh_file.hpp"

namespace suture::bench {
namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

struct WorkOptions {
  std::vector<std::string> cases;  ///< none: all
  bool largest = false, beside = true, references = false;
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

/// Any of a case's methods: CalculiX needs the mesh, the material and the loads only.
nlohmann::json scene_for_calculix(const WorkCase& what, const WorkMesh& mesh) {
  return what.scene(mesh, what.methods.front());
}

Mesh mesh_of(const WorkCase& what, const WorkMesh& mesh) {
  return what.mesh ? what.mesh(mesh) : box_of(scene_for_calculix(what, mesh));
}

double dofs_of(const Mesh& mesh) { return 3.0 * static_cast<double>(mesh.points.size()); }

/// What `suture run` reads.
void write_scene(const std::filesystem::path& folder, const WorkCase& what,
                 const WorkMethod& method, const WorkMesh& work_mesh, const Mesh& mesh) {
  std::ofstream(folder / "scene.json") << what.scene(work_mesh, method).dump(1) << '\n';
  Diagnostics ignored;
  if (what.mesh) write_mesh(folder / WorkCase::mesh_file, mesh, ignored);
}

WorkRow run_suture(const WorkOptions& options, const WorkCase& what, const WorkMethod& method,
                   const WorkMesh& work_mesh, const Mesh& mesh) {
  const WorkingFolder folder;
  write_scene(folder.path(), what, method, work_mesh, mesh);
  WorkRow row{what.name, "Suture", method.name, work_mesh.name(), dofs_of(mesh)};
  int code = 0;
  repeat(options, row, [&] {
    const ProcessUse use = run_process(
        {suture_program(), "run", "-q", "scene.json", "--output", "out"}, folder.path());
    code = use.code;
    return std::pair{use.cpu, use.wall};
  });
  if (code != 0) row.note = "stopped, exit code " + std::to_string(code);
  if (code == 5) row.note = "no equilibrium was found (exit code 5)";
  if (code == 0)
    row.error =
        what.scale * last_value(folder.path() / "out/probes.csv", what.column) / what.reference - 1;
  return row;
}

/// The value that a column "tip displacement y [m]" shows, scaled.
double value_of(const WorkCase& what, const CalculixRun& found) {
  const char component = what.column[what.column.find(" [") - 1];
  return what.scale * found.probe[static_cast<std::size_t>(component - 'x')];
}

WorkRow run_ccx(const WorkOptions& options, const WorkCase& what, const CalculixMethod& method,
                const WorkMesh& work_mesh, const Mesh& mesh) {
  WorkRow row{what.name, "CalculiX", method.element + " " + method.solver, work_mesh.name(),
              dofs_of(mesh)};
  try {
    repeat(options, row, [&] {
      const CalculixRun found =
          run_calculix(scene_for_calculix(what, work_mesh), mesh, {method.element, method.solver});
      row.dofs = found.dofs;
      row.error = value_of(what, found) / what.reference - 1;
      return std::pair{found.seconds, found.wall};
    });
  } catch (const IoError& error) {
    row.note = error.what();
  }
  return row;
}

void run_case(const WorkOptions& options, const WorkCase& what, Report& report) {
  char reference[32];
  std::snprintf(reference, sizeof reference, "%.6g", what.reference);
  report.begin(what.name, std::string("relative to ") + reference + ": " + what.source);
  std::vector<WorkRow> rows;
  const auto show = [](const WorkRow& row) {
    std::printf("%s, %s, %s: %.4g s, %.3g %%  %s\n", row.program.c_str(), row.method.c_str(),
                row.mesh.c_str(), row.cpu, 100 * row.error, row.note.c_str());
    std::fflush(stdout);
  };
  const auto run_all = [&](const auto& methods, auto run) {
    for (const auto& method : methods)
      for (const WorkMesh& work_mesh : method.meshes) {
        const Mesh mesh = mesh_of(what, work_mesh);
        if (dofs_of(mesh) <= options.most_dofs)
          show(rows.emplace_back(run(options, what, method, work_mesh, mesh)));
      }
  };
  run_all(what.methods, run_suture);
  if (options.beside && has_calculix()) run_all(what.beside, run_ccx);
  mark_front(rows);
  for (const WorkRow& row : rows) report.add(row.line());
}

// --------------------------------------------------------------- references --

/// The limit for h -> 0 of values c + a h^p on three meshes, and p.
std::pair<double, double> extrapolated(const std::array<double, 3>& h,
                                       const std::array<double, 3>& value) {
  const double ratio = (value[0] - value[1]) / (value[1] - value[2]);
  double low = 0.01, high = 20;
  for (int i = 0; i < 100; ++i) {
    const double p = (low + high) / 2;
    const double found =
        (std::pow(h[0], p) - std::pow(h[1], p)) / (std::pow(h[1], p) - std::pow(h[2], p));
    (found < ratio ? low : high) = p;
  }
  const double part = std::pow(h[2], low) / (std::pow(h[1], low) - std::pow(h[2], low));
  return {value[2] - part * (value[1] - value[2]), low};
}

/// CalculiX's own values on the finest meshes that it solves, with the limit that they approach.
void run_reference(const WorkCase& what, Report& report) {
  const CalculixMethod& finest = what.finest;
  if (finest.meshes.empty()) return;
  report.begin("reference: " + what.name,
               "CalculiX, " + finest.element + ", Newton's method to 1e-9");
  std::array<double, 3> h{}, values{};
  for (std::size_t i = 0; i < 3; ++i) {
    const WorkMesh& mesh = finest.meshes[i];
    const CalculixRun found = run_calculix(scene_for_calculix(what, mesh), mesh_of(what, mesh),
                                           {finest.element, finest.solver, true});
    h[i] = 1.0 / mesh.cells[0];
    values[i] = value_of(what, found);
    report.add(Line().add("mesh", mesh.name()).add("dofs", found.dofs).add("value", values[i]));
  }
  const auto [limit, order] = extrapolated(h, values);
  report.add(
      Line().add("limit", limit).add("order", order).add("finest_is_off", values[2] / limit - 1));
  std::printf("%.8g %.8g %.8g: limit %.8g\n", values[0], values[1], values[2], limit);
}

void run_work(const WorkOptions& options, Report& report) {
  if (options.beside && !has_calculix())
    std::printf("CalculiX (ccx) is not installed: its rows are left out\n");
  for (const WorkCase& what : work_cases(options.largest))
    if (options.cases.empty() || std::ranges::count(options.cases, what.name) > 0)
      options.references ? run_reference(what, report) : run_case(options, what, report);
}

}  // namespace

void add_work_precision(CommandLine& line) {
  auto [command, options] =
      line.add("work-precision", "Error against run time of whole processes", run_work);
  std::vector<std::string> names;
  for (const WorkCase& known : work_cases(false)) names.push_back(known.name);
  command.option("--cases", &options.cases, "Problems; default: all").one_of(names);
  command.flag("--largest", &options.largest, "With meshes that take longer than 5 s");
  command.flag("!--no-calculix", &options.beside, "Leave out CalculiX");
  command.flag("--references", &options.references,
               "Only CalculiX's values that references are extrapolated from");
  command.option("--dofs", &options.most_dofs, "Largest number of unknowns of a mesh").positive();
  command.option("--rounds", &options.rounds, "Repetitions").positive();
}

}  // namespace suture::bench
