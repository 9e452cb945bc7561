// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/paper_runs.hpp"

#include <cmath>
#include <fstream>
#include <sstream>

#include "apps/suture-bench/process.hpp"
#include "apps/suture-bench/work_scene.hpp"

namespace suture::bench {
namespace {

/// Members of a solver, and a step for the first try, s; 0: the scheme's own.
struct Scheme {
  const char *name, *members;
  double step;
};

const Scheme schemes[] = {
    {"explicit", R"({"integrator": "velocity-verlet"})", 0},
    {"implicit-euler", R"({"integrator": "implicit-euler"})", 1. / 60},
    {"implicit-euler, 10 iterations",
     R"({"integrator": "implicit-euler", "budget": {"iterations": 10}})", 1. / 60},
    {"xpbd", R"({"integrator": "xpbd"})", 1. / 240}};

ProbeTable run(const SchemeRuns& runs, const Scheme& scheme, double step) {
  nlohmann::json with = runs.scene;
  with["solver"] = nlohmann::json::parse(scheme.members);
  with["solver"].update({{"end", runs.end}, {"damping", runs.damping}, {"threads", 1}});
  if (step > 0) with["solver"]["dt"] = step;
  return ProbeTable(with);
}

}  // namespace

ProbeTable::ProbeTable(const nlohmann::json& scene) {
  const WorkingFolder folder;
  std::ofstream(folder.path() / "scene.json") << scene.dump(1) << '\n';
  const ProcessUse use =
      run_process({suture_program(), "run", "-q", "scene.json", "--output", "out"}, folder.path());
  code = use.code;
  cpu = use.cpu;
  std::ifstream table(folder.path() / "out/probes.csv");
  std::vector<std::string> names;
  for (std::string line, cell; std::getline(table, line);) {
    std::istringstream cells(line);
    const bool is_head = names.empty();
    for (std::size_t i = 0; std::getline(cells, cell, ','); ++i)
      if (is_head)
        names.push_back(cell);
      else
        columns[names[i]].push_back(std::stod(cell));
  }
}

double ProbeTable::last(const std::string& column) const {
  const auto found = columns.find(column);
  return found == columns.end() ? unknown : found->second.back();
}

double ProbeTable::at(double time, const std::string& column) const {
  const auto times = columns.find("time [s]");
  if (times == columns.end()) return unknown;
  for (std::size_t i = 0; i < times->second.size(); ++i)
    if (std::abs(times->second[i] - time) < 1e-9 * time) return columns.at(column)[i];
  return unknown;
}

void SchemeRuns::report_all(const std::string& model, Report& report) const {
  double wanted = 0;
  for (const Scheme& scheme : schemes) {
    double step = scheme.step;
    ProbeTable found = run(*this, scheme, step);
    if (step == 0) wanted = found.cpu;
    for (int i = 0; i < 2 && step > 0; ++i) {
      step *= found.cpu / wanted;
      found = run(*this, scheme, step);
    }
    const bool is_whole = found.code == 0;
    const double value = is_whole ? scale * found.last(column) : unknown;
    report.add(
        Line()
            .add("model", model)
            .add("scheme", scheme.name)
            .add("dt, s", step > 0 ? step : unknown)
            .add("CPU, s", found.cpu)
            .add("value", value)
            .add("value / equilibrium - 1", value / equilibrium - 1)
            .add("note", is_whole ? "" : "stopped, exit code " + std::to_string(found.code)));
  }
}

}  // namespace suture::bench
