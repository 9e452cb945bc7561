// SPDX-License-Identifier: GPL-3.0-or-later
//
// The paper's experiments (Golec, Coquet, Zara, Damiand, WSCG 2015), Fig. 6, 7, 13 and 14, by whole
// runs of `suture run`: beside the formula or law that the paper compares with, and references of
// other programs.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/suture-bench/commands.hpp"
#include "apps/suture-bench/paper_runs.hpp"
#include "apps/suture-bench/process.hpp"
#include "apps/suture-bench/work_scene.hpp"
#include "kernel/base/error.hpp"
#include "kernel/base/module.hpp"

namespace suture::bench {
namespace {

using Json = nlohmann::json;

struct PaperOptions {
  std::vector<Index> across{5, 10};        ///< elements over the beam's height
  std::array<Index, 3> block{30, 10, 10};  ///< of liver
  Index frames = 20;                       ///< equilibria until 2 s
  std::filesystem::path pictures{};        ///< where the runs of Fig. 7 go; empty: not run
  bool schemes = false;                    ///< only the schemes at equal time
  std::string figure{};                    ///< only this one, with its picture; empty: all
  std::filesystem::path picture{};         ///< of it; empty: figure-N.png
};

std::string note_of(int code) {
  if (code == 0) return "";
  if (code == 5) return "no equilibrium was found (exit code 5)";
  return "exit code " + std::to_string(code);
}

// -------------------------------------------------------------------- Fig. 6 --

constexpr double stations[] = {0.25, 0.5, 0.75, 1};  // m

/// The paper's beam at one load, with a reference in three dimensions.
struct BeamLoad {
  const char* name;
  const char* cantilever;
  double reference[4];  ///< uy at the stations, m
  const char* source;
};

constexpr BeamLoad beam_loads[] = {
    {"full",
     "A",
     {-0.0701141807, -0.2018940808, -0.3553193745, -0.5119929186},
     "DOLFINx, 10x10x40 quadratic"},
    {"1/1000",
     "B",
     {-7.545390421e-5, -2.301885932e-4, -4.186071992e-4, -6.131836275e-4},
     "DOLFINx, 12x12x36 quadratic, graded"}};

/// y = rho g l h / (24 E I) (4 L x^3 - 6 L^2 x^2 - x^4), I = l h^3 / 12.
double beam_formula(double gravity, double x) {
  constexpr double rho = 1000, young = 4e5, h = 0.25, length = 1;
  return rho * gravity / (2 * young * h * h) *
         (4 * length * std::pow(x, 3) - 6 * length * length * x * x - std::pow(x, 4));
}

std::string station_name(double x) { return "y" + std::to_string(static_cast<int>(100 * x)); }

/// The mean displacement of the nodes nearest to the axis of the beam, at each station.
Json beam_probes(Index n) {
  const double reach = 0.6 * 0.25 / n;
  Json probes = Json::array();
  for (const double x : stations)
    probes.push_back({{"name", station_name(x)},
                      {"fields", {"displacement"}},
                      {"where",
                       {{"box",
                         {{"min", {x - 1e-6, 0.125 - reach, 0.125 - reach}},
                          {"max", {x + 1e-6, 0.125 + reach, 0.125 + reach}}}}}}});
  return probes;
}

struct BeamModel {
  const char *name, *model, *parameters, *solver;
};

constexpr const char* relaxed = R"({"until": "rest", "on_inversion": "warn"})";
constexpr const char* balanced = R"({"static": {}})";
const BeamModel beam_models[] = {
    {"MSS", "mss-baudet", "{}", relaxed},
    {"MSS, corrected", "mss-baudet", R"({"correction": true})", relaxed},
    {"MSS with volume (mss-golec)", "mss-golec", "{}", balanced},
    {"TM", "tm-faure", "{}", balanced},
    {"TM, mean gradient", "tm-faure", R"({"element": "mean-gradient"})", balanced}};

Line beam_line(const BeamLoad& load, const std::string& model, const std::string& mesh,
               const std::array<double, 4>& y, const std::string& note) {
  const double formula = beam_formula(cantilever(load.cantilever).gravity, 1);
  Line line;
  line.add("load", load.name).add("model", model).add("mesh", mesh);
  for (std::size_t i = 0; i < 4; ++i)
    line.add("y at " + std::to_string(25 * (i + 1)) + " cm, m", y[i]);
  line.add("tip / formula - 1", y[3] / formula - 1)
      .add("tip / 3D reference - 1", y[3] / load.reference[3] - 1)
      .add("note", note);
  return line;
}

void run_beam(const BeamLoad& load, const BeamModel& model, Index n, Report& report) {
  const WorkMethod method{model.name, model.model, model.parameters, model.solver};
  Json scene = cantilever_scene(cantilever(load.cantilever), {{4 * n, n, n}}, method);
  scene["output"]["probes"]["at"] = beam_probes(n);
  const ProbeTable found(scene);
  std::array<double, 4> y{};
  for (std::size_t i = 0; i < 4; ++i)
    y[i] = found.last(station_name(stations[i]) + " displacement y [m]");
  const std::string mesh =
      std::to_string(n) + "x" + std::to_string(n) + "x" + std::to_string(4 * n);
  report.add(beam_line(load, model.name, mesh, y, note_of(found.code)));
}

void run_beams(const PaperOptions& options, Report& report) {
  report.begin("Fig. 6", "the cantilever at rest, deflection of its axis");
  for (const BeamLoad& load : beam_loads) {
    std::array<double, 4> y{};
    for (std::size_t i = 0; i < 4; ++i)
      y[i] = beam_formula(cantilever(load.cantilever).gravity, stations[i]);
    report.add(beam_line(load, "beam formula", "", y, "of small deflections, without shear"));
    std::ranges::copy(load.reference, y.begin());
    report.add(beam_line(load, "3D reference", "", y, load.source));
    for (const BeamModel& model : beam_models)
      for (const Index n : options.across) run_beam(load, model, n, report);
  }
}

/// Until all is at rest but for 1e-3 of the tip.
void run_beams_by_scheme(const PaperOptions& options, Report& report) {
  const Index n = options.across.front();
  report.begin("Fig. 6, schemes",
               "the cantilever at a quarter of the paper's load, " + std::to_string(n) +
                   " elements over its height; it moves for 8 s with a damping of 2/s. Tip in the "
                   "end, m, beside the equilibrium of the same mesh");
  for (const BeamModel& model : beam_models) {
    const WorkMethod method{model.name, model.model, model.parameters, balanced};
    const Json scene = cantilever_scene(cantilever("A0.25"), {{4 * n, n, n}}, method);
    const std::string column = "tip displacement y [m]";
    const double equilibrium = ProbeTable(scene).last(column);
    SchemeRuns{scene, 8, 2, column, 1, equilibrium}.report_all(model.name, report);
  }
}

void run_scene(const Json& scene, const std::filesystem::path& folder, const std::string& name) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder / (name + ".json")) << scene.dump(1) << '\n';
  run_process({suture_program(), "run", "-q", name + ".json", "--output", name}, folder);
}

// -------------------------------------------------------------------- Fig. 7 --

/// The largest principal strain of any element, by which the figure is coloured.
constexpr const char* strain_column = "strain principal_strain 1";
const Json strain_probe{{"name", "strain"},
                        {"fields", {"principal_strain"}},
                        {"of", "max"},
                        {"where", {{"box", {{"min", {-1, -1, -1}}, {"max", {2, 2, 2}}}}}}};

/// visit(name, scene) for the models of the figure, at the paper's load.
template <class Visit>
void for_each_shape(Visit visit) {
  for (const BeamModel& model : beam_models) {
    const std::string name = model.name;
    if (name != "MSS" && name != "TM") continue;
    const WorkMethod method{name, model.model, model.parameters, model.solver};
    visit(name, cantilever_scene(cantilever("A"), {{40, 10, 10}}, method));
  }
}

/// The equilibria of MSS and TM as frames, in the folders MSS and TM.
void write_equilibria(const std::filesystem::path& folder) {
  for_each_shape([&](const std::string& name, Json scene) {
    scene["output"] = {{"fields", {"displacement", "principal_strain"}}};
    run_scene(scene, folder, name);
  });
}

void run_shapes_by_scheme(Report& report) {
  report.begin("Fig. 7, schemes",
               "the cantilever at the paper's load, 10x10x40 elements; it moves for 4 s with a "
               "damping of 4/s. Largest principal strain of any element in the end, beside the "
               "equilibrium of the same mesh");
  for_each_shape([&](const std::string& name, Json scene) {
    scene["output"]["probes"]["at"].push_back(strain_probe);
    const double equilibrium = ProbeTable(scene).last(strain_column);
    SchemeRuns{scene, 4, 4, strain_column, 1, equilibrium}.report_all(name, report);
  });
}

// ------------------------------------------------------------------- Fig. 14 --

constexpr double consistency = 861, exponent = 0.1138;  // Pa s^n, -
constexpr double rates[] = {0.0151, 0.133, 0.67};       // 1/s

/// sigma = K r t^(1-n) / Gamma(2-n)
double measured_law(double rate, double time) {
  return consistency * rate * std::pow(time, 1 - exponent) / std::tgamma(2 - exponent);
}

/// A block between two plates, one of which moves at a constant rate of shear until `end`. One
/// element is in ideal simple shear.
Json shear_scene(const std::array<Index, 3>& cells, const WorkMethod& method, const Json& material,
                 double rate, double end, Index frames) {
  const double side = 1e-3;
  const Vec3 size{side * cells[0], side * cells[1], side * cells[2]};
  Json scene = box_scene({cells}, size, method, material);
  scene["solver"] = {{"static", {{"frames", frames}}}, {"end", end}, {"on_inversion", "warn"}};
  scene["constraints"] = {held("y0"),
                          {{"move", {{"translation", {rate * end * size[1], 0, 0}}}},
                           {"ramp", end},
                           {"where", {{"set", "y1"}}}}};
  scene["output"] =
      tables({{"name", "plate"}, {"fields", {"reaction"}}, {"where", {{"set", "y1"}}}});
  scene["output"]["probes"]["every_steps"] = 1;
  return scene;
}

/// Mean shear stress on the moved plate at a time, Pa.
double stress_at(const ProbeTable& table, double time, const std::array<Index, 3>& cells) {
  return table.at(time, "plate reaction x [N]") / (1e-6 * cells[0] * cells[2]);
}

struct LiverModel {
  const char* name;
  WorkMethod method;
  Json material;
};

Json power_law_material(double tau) {
  return {{"K", consistency}, {"n", exponent}, {"lambda", 166444.3}, {"rho", 1000}, {"tau", tau}};
}

std::vector<LiverModel> liver_models() {
  const Json elastic{{"E", 1000}, {"nu", 0.499}, {"rho", 1000}};
  return {{"MSS", static_method("mss-baudet", ""), elastic},
          {"TM", static_method("tm-faure", "trilinear"), elastic},
          {"TM, mean gradient", static_method("tm-faure", "mean-gradient"), elastic},
          {"visco", static_method("visco", ""), power_law_material(1e-3)}};
}

void run_liver(const PaperOptions& options, Report& report) {
  constexpr double end = 2;
  report.begin("Fig. 14",
               "shear of a block of liver at three rates, quasi-static: stress on the plate, Pa, "
               "and the law that was measured, K r t^(1-n) / Gamma(2-n)");
  for (const double rate : rates) {
    std::vector<ProbeTable> found;
    const std::vector<LiverModel> models = liver_models();
    for (const LiverModel& model : models)
      found.emplace_back(
          shear_scene(options.block, model.method, model.material, rate, end, options.frames));
    for (Index i = 1; i <= options.frames; ++i) {
      const double time = end * i / options.frames;
      Line line;
      line.add("rate, 1/s", rate).add("t, s", time).add("shear", rate * time);
      line.add("measured law", measured_law(rate, time));
      for (std::size_t m = 0; m < models.size(); ++m)
        line.add(models[m].name, stress_at(found[m], time, options.block));
      report.add(std::move(line));
    }
  }
}

void run_liver_by_scheme(const PaperOptions& options, Report& report) {
  constexpr double end = 0.5, rate = rates[1];
  report.begin("Fig. 14, schemes",
               "the block of liver sheared at 0.133/s for 0.5 s with a damping of 20/s: stress on "
               "the plate in the end, Pa, beside the equilibrium of the same block");
  for (const LiverModel& model : liver_models()) {
    if (model.name == std::string("visco")) continue;  // 5 equilibria are too few for its rate
    const Json scene = shear_scene(options.block, model.method, model.material, rate, end, 5);
    const double equilibrium = stress_at(ProbeTable(scene), end, options.block);
    const double area = 1e-6 * options.block[0] * options.block[2];
    SchemeRuns{scene, end, 20, "plate reaction x [N]", 1 / area, equilibrium}.report_all(model.name,
                                                                                         report);
  }
}

/// One element at rates so small that the law is linear.
void run_small_rates(Report& report) {
  report.begin("power law, one element",
               "ideal simple shear at the paper's rates times 1e-4, 1,000 equilibria until the "
               "time of the row: stress of visco / law - 1");
  const WorkMethod visco = static_method("visco", "");
  for (const double time : {0.1, 0.3, 1.0, 3.0, 10.0}) {
    Line line;
    line.add("t, s", time);
    for (const double rate : rates) {
      const ProbeTable found(
          shear_scene({1, 1, 1}, visco, power_law_material(1e-3), 1e-4 * rate, time, 1000));
      char name[40];
      std::snprintf(name, sizeof name, "rate %g 1/s", 1e-4 * rate);
      line.add(name, stress_at(found, time, {1, 1, 1}) / measured_law(1e-4 * rate, time) - 1);
    }
    report.add(std::move(line));
  }
}

/// Sides that are free make the block softer than a plate without end: 0.914 times as stiff.
void run_linear_range(const PaperOptions& options, Report& report) {
  constexpr double of_free_sides = 0.913770;  // DOLFINx, linear, nu = 0.499
  constexpr Index frames = 40;
  report.begin("power law, block",
               "the block at the paper's rates, visco with tau a hundredth of the time to a shear "
               "of 0.01, 40 equilibria to a shear of 0.01 and 40 to 0.1: stress / (0.914 times the "
               "law) - 1");
  const WorkMethod visco = static_method("visco", "");
  for (const double most : {0.01, 0.1}) {
    std::vector<ProbeTable> found;
    for (const double rate : rates)
      found.emplace_back(shear_scene(options.block, visco, power_law_material(1e-4 / rate), rate,
                                     most / rate, frames));
    for (const Index i : {frames / 4, frames / 2, frames}) {
      Line line;
      line.add("shear", most * i / frames);
      for (std::size_t r = 0; r < found.size(); ++r) {
        const double time = most * i / frames / rates[r];
        char name[40];
        std::snprintf(name, sizeof name, "rate %g 1/s", rates[r]);
        line.add(name, stress_at(found[r], time, options.block) /
                               (of_free_sides * measured_law(rates[r], time)) -
                           1);
      }
      report.add(std::move(line));
    }
  }
}

/// Fig. 13: the block of springs between the plates, sheared at the second rate for a second.
void write_block(const PaperOptions& options, const std::filesystem::path& folder) {
  const LiverModel mss = liver_models().front();
  Json scene = shear_scene(options.block, mss.method, mss.material, rates[1], 1, 10);
  scene["output"]["frames"] = true;
  scene["output"]["fields"] = {"displacement"};
  run_scene(scene, folder, mss.name);
}

// ----------------------------------------------------------------- one figure --

/// Makes the runs of a figure in a folder; returns the command that draws them there.
std::vector<std::string> prepare_figure(const PaperOptions& options, Report& report,
                                        const std::filesystem::path& folder,
                                        const std::string& picture) {
  if (options.figure == "7") {
    write_equilibria(folder);
    return {suture_program(), "plot", "MSS", "TM", "-o", picture};
  }
  if (options.figure == "13") {
    write_block(options, folder);
    return {suture_program(), "plot", "MSS", "-o", picture};
  }
  (options.figure == "6" ? run_beams : run_liver)(options, report);
  report.write_json(folder / "paper.json");
  const auto script = own_prefix() / SUTURE_INSTALL_DATADIR "/suture/bench/paper.py";
  return {SUTURE_PYTHON, script, "--figure", options.figure, "paper.json", picture};
}

void draw_figure(const PaperOptions& options, Report& report) {
  const WorkingFolder folder;
  const auto picture = std::filesystem::absolute(
      options.picture.empty() ? std::filesystem::path("figure-" + options.figure + ".png")
                              : options.picture);
  if (run_process(prepare_figure(options, report, folder.path(), picture), folder.path()).code != 0)
    throw IoError(
        picture.string() +
        ": could not be drawn; pictures need python3-matplotlib and python3-vtk9, and end "
        "in .png, .pdf or .svg");
  std::printf("%s\n", picture.c_str());
}

void run_paper(const PaperOptions& options, Report& report) {
  if (!options.figure.empty()) return draw_figure(options, report);
  run_beams_by_scheme(options, report);
  run_shapes_by_scheme(report);
  run_liver_by_scheme(options, report);
  if (options.schemes) return;
  run_beams(options, report);
  run_small_rates(report);
  run_linear_range(options, report);
  run_liver(options, report);
  if (!options.pictures.empty()) write_equilibria(options.pictures);
}

}  // namespace

void add_paper(CommandLine& line) {
  auto [command, options] =
      line.add("paper", "The paper's experiments beside their references", run_paper);
  command.option("--across", &options.across, "Elements over the height of the beam");
  command.option("--block", &options.block, "Elements of the block of liver");
  command.flag("--schemes", &options.schemes, "Only the tables of integrators at equal time");
  command.option("--frames", &options.frames, "Equilibria of the shear of liver").positive();
  command
      .option(
          "--figure", &options.figure,
          "Only this figure, with its picture (5: suture-bench cut; 8: suture-bench scaling; 9, "
          "10: suture run and plot of the scenes cut-beam and letters)")
      .one_of({"6", "7", "13", "14"});
  command.option("-o,--output", &options.picture, "The picture of it; default: figure-N.png");
  command.option("--pictures", &options.pictures,
                 "Folder for the frames of Fig. 7, for docs/images/render.py --beside");
}

}  // namespace suture::bench
