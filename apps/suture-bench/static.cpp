// SPDX-License-Identifier: GPL-3.0-or-later
//
// Time, iterations and error of static equilibria: from rest, and after a cut. static.py puts
// CalculiX beside them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>

#include "apps/suture-bench/cantilever.hpp"
#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/machine.hpp"
#include "apps/suture-bench/solve_case.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/base/error.hpp"
#include "kernel/forces/gravity.hpp"
#include "kernel/topology/dart.hpp"

namespace suture::bench {
namespace {

struct StaticOptions {
  std::vector<std::string> cases{"A", "A0.25"}, models{"tm-faure"},
      elements{"trilinear", "mean-gradient"}, files;
  std::vector<Index> across{5, 10, 20};
  bool distorted = false;
  double cut = 1;  ///< % of the inner faces; 0: no cuts
};

/// What is asked of tm-faure on boxes, us per element.
double asked(const std::string& name, const std::string& element, Index across) {
  static const std::map<std::tuple<std::string, std::string, Index>, double> all{
      {{"A", "trilinear", 10}, 12.5},        {{"A", "trilinear", 20}, 0.35e6 / 32000},
      {{"A0.25", "trilinear", 10}, 9},       {{"A0.25", "trilinear", 20}, 8.5},
      {{"A0.25", "trilinear", 40}, 9.5},     {{"A0.25", "trilinear", 80}, 10},
      {{"A0.25", "mean-gradient", 10}, 7.5}, {{"A0.25", "mean-gradient", 20}, 0.2e6 / 32000}};
  const auto found = all.find({name, element, across});
  return found == all.end() ? unknown : found->second;
}

// -------------------------------------------------------------------- from rest --

struct Solution {
  double seconds = 0, newton = 0, krylov = 0, coarse = 0;
  bool found = true;
};

/// The next equilibrium of a body; `found` is false if there is none within reach.
Solution solve(Dynamics& dynamics) {
  Solution result;
  const Work work(dynamics);
  const double begin = now(1);
  try {
    dynamics.step(1, dynamics.time() + 1);
  } catch (const NumericalError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    result.found = false;
  }
  result.seconds = now(1) - begin;
  result.newton = work.newton;
  result.krylov = work.krylov;
  result.coarse = work.coarse;
  return result;
}

/// One row of a table; figures that a row does not have are NaN.
struct Row {
  std::string name, model, element;
  double elements = 0, faces = 0;
  Solution solution{};
  double asked_us = unknown, whole_seconds = unknown, growth = unknown, tip = unknown,
         discrete = unknown, converged = unknown, peak = 0;

  Line line() const {
    Line line;
    line.add("case", name).add("model", model).add("element", element).add("elements", elements);
    if (faces > 0) line.add("faces_cut", faces);
    line.add("seconds", solution.seconds)
        .add("us_per_element", 1e6 * solution.seconds / elements)
        .add("asked_us", asked_us)
        .add("growth", growth)
        .add("coarse_steps", solution.coarse)
        .add("newton_steps", solution.newton)
        .add("krylov_iterations", solution.krylov);
    if (faces == 0)
      line.add("relative_error", std::abs(tip / converged - 1))
          .add("discrete_error", std::abs(tip / discrete - 1))
          .add("with_mesh_s", whole_seconds);
    return line.add("peak_mb", peak / 1e6);
  }
};

/// The element type that a body of the model has, or "" if the model knows none.
std::string element_of(const suture_model& model, const std::string& wanted) {
  for (const suture_parameter& p : std::span(model.parameters, model.parameter_count))
    if (std::string_view(p.name) == "element") return wanted;
  return "";
}

class Bench {
 public:
  Bench(const StaticOptions& options, Report& report) : options_(options), report_(report) {}

  void run() {
    report_.begin("static",
                  "cantilever of 1 m under its weight (E 400 kPa, rho 1000; H: nu as named, others "
                  "0.3) from rest to 1e-8, after the mesh is read and the body built: CPU s of one "
                  "thread; growth: exponent of the time since the row before; relative_error: of "
                  "the tip beside converged solutions, discrete_error: beside DOLFINx on the same "
                  "mesh");
    for (const std::string& name : options_.cases)
      for_each_use([&](const suture_model& model, const std::string& element) {
        for (const Index n : options_.across) from_rest(cantilever(name), model, element, n);
      });
    if (options_.cut > 0) after_cuts();
  }

 private:
  template <class Visit>
  void for_each_use(Visit visit) {
    for (const std::string& name : options_.models) {
      const suture_model& model = host_.model(name);
      std::vector<std::string> elements = options_.elements;
      if (element_of(model, "any").empty()) elements = {""};
      for (const std::string& element : elements) visit(model, element);
    }
  }

  void from_rest(const Cantilever& what, const suture_model& model, const std::string& element,
                 Index n) {
    forget_peak();
    const double begin = now(1);
    BenchBody body(host_, options_of(what, model, {n, element, options_.distorted}));
    Row row{.name = what.name, .model = model.id, .element = element};
    row.elements = body.element_count();
    row.solution = solve(body.dynamics());
    row.whole_seconds = now(1) - begin;
    row.peak = peak_bytes();
    row.growth = growth(row);
    const bool is_paper = row.model == "tm-faure" && !options_.distorted;
    if (is_paper) row.asked_us = asked(what.name, element, n);
    if (row.solution.found) row.tip = tip_of(body, n);
    if (model.id == std::string("tm-faure")) row.converged = what.converged;
    if (is_paper && element == "trilinear") row.discrete = what.discrete_tip(n);
    report_.add(row.line());
  }

  /// log(time ratio) / log(size ratio) to the row before, if it is of the same series.
  double growth(const Row& row) {
    const Row before = std::exchange(last_, row);
    if (before.name != row.name || before.model != row.model || before.element != row.element ||
        before.elements >= row.elements)
      return unknown;
    return std::log(row.solution.seconds / before.solution.seconds) /
           std::log(row.elements / before.elements);
  }

  // -------------------------------------------------------------- after a cut --

  void after_cuts() {
    char note[200];
    std::snprintf(note, sizeof note,
                  "the cantilever at a quarter of its weight, and meshes of files: the new "
                  "equilibrium after a slit from the free end through %g %% of the inner faces, "
                  "hierarchy included",
                  options_.cut);
    report_.begin("static, after a cut", note);
    for_each_use([&](const suture_model& model, const std::string& element) {
      for (const Index n : options_.across) {
        BenchBody body(host_,
                       options_of(cantilever("A0.25"), model, {n, element, options_.distorted}));
        after_cut("A0.25", model, element, body.body(), body.dynamics(), options_.distorted);
      }
    });
    for (const std::string& file : options_.files) of_file(file);
  }

  void after_cut(const std::string& name, const suture_model& model, const std::string& element,
                 Body& body, Dynamics& dynamics, bool foreign) {
    forget_peak();
    if (!solve(dynamics).found) return;
    const std::vector<Dart> faces = slit(body);
    body.cut(faces);
    Row row{.name = name, .model = model.id, .element = element};
    row.elements = body.complex().existing(3);
    row.faces = static_cast<double>(faces.size());
    row.solution = solve(dynamics);
    row.peak = peak_bytes();
    if (row.model == "tm-faure" && options_.cut == 1) row.asked_us = foreign ? 50 : 12;
    report_.add(row.line());
  }

  /// A mesh that is held at its lowest tenth and bent by a weight that is a thousandth of E.
  void of_file(const std::string& file) {
    const auto body = body_of(case_of_file(file), host_);
    Attributes& attributes = body->attributes();
    double low = attributes.rest().get(0, 2), high = low;
    for (Index v = 0; v < attributes.vertex_count(); ++v) {
      low = std::min(low, attributes.rest().get(v, 2));
      high = std::max(high, attributes.rest().get(v, 2));
    }
    const double g = 1e-3 * 400e3 / (1000 * (high - low));
    body->add(std::make_unique<Gravity>(attributes, Vec3{0, -g, 0}, TimeRamp{}));
    Dynamics dynamics(*body, DynamicsOptions{"static"});
    dynamics.start();
    after_cut(std::filesystem::path(file).stem(), host_.model("tm-faure"), "trilinear", *body,
              dynamics, true);
  }

  /// A slit between the halves left and right of the middle, from the free end: faces that are cut
  /// at random would hardly split a vertex.
  std::vector<Dart> slit(const Body& body) const {
    std::vector<Vec3> centres;
    for (Index e = 0; e < body.complex().element_count(); ++e)
      centres.push_back(centre_of(body, e));
    const auto [left, right] = std::ranges::minmax(centres, {}, [](const Vec3& c) { return c[0]; });
    const double middle = left[0] + 0.5001 * (right[0] - left[0]);
    std::vector<std::pair<double, Dart>> faces;  // by depth
    std::size_t inner = 0;
    for (Index e = 0; e < centres.size(); ++e)
      for (int f = 0; f < hexahedron::faces; ++f) {
        const Index other = body.complex().neighbour(e, f);
        if (other == none || other < e) continue;
        ++inner;
        if ((centres[e][0] < middle) != (centres[other][0] < middle))
          faces.emplace_back(-centres[e][2], face_dart(e, f));
      }
    std::ranges::sort(faces);
    const double wanted = options_.cut / 100 * static_cast<double>(inner);
    faces.resize(std::min(faces.size(), static_cast<std::size_t>(std::ceil(wanted))));
    std::vector<Dart> darts;
    for (const auto& [depth, face] : faces) darts.push_back(face);
    return darts;
  }

  const StaticOptions& options_;
  Report& report_;
  PluginHost host_;
  Row last_;
};

void run_static(const StaticOptions& options, Report& report) { Bench(options, report).run(); }

}  // namespace

void add_static(CommandLine& line) {
  auto [command, options] =
      line.add("static", "Time, iterations and error of static equilibria", run_static);
  std::vector<std::string> names;
  for (const Cantilever& known : cantilevers()) names.push_back(known.name);
  command.option("--cases", &options.cases, "Loads and materials").one_of(names);
  command.option("--across", &options.across, "Cells over the height; four times that along");
  command.option("--models", &options.models, "Models with the parameters E, nu and rho");
  command.option("--elements", &options.elements, "Element types of the models");
  command.flag("--distorted", &options.distorted, "General hexahedra");
  command.option("--cut", &options.cut, "% of the inner faces that are cut; 0: none")
      .within(0., 100.);
  command.option("--files", &options.files, "Meshes to cut, held at their lowest tenth");
}

}  // namespace suture::bench
