// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/work_cases.hpp"

#include <cmath>

#include "apps/suture-bench/solid_cases.hpp"

namespace suture::bench {
namespace {

using Json = nlohmann::json;

// ------------------------------------------------------------------- meshes --

WorkMesh beam_mesh(Index n) { return {{4 * n, n, n}}; }

std::vector<WorkMesh> beam_meshes(std::initializer_list<Index> sections) {
  std::vector<WorkMesh> meshes;
  for (const Index n : sections) meshes.push_back(beam_mesh(n));
  return meshes;
}

/// Cells that grow from the clamp to the tip, where little happens.
std::vector<WorkMesh> graded_meshes() {
  return {{{9, 3, 3}, 8},     {{12, 4, 4}, 8},    {{16, 4, 4}, 16},   {{24, 6, 6}, 16},
          {{24, 8, 8}, 8},    {{36, 12, 12}, 8},  {{48, 16, 16}, 16}, {{60, 20, 20}, 16},
          {{60, 24, 24}, 24}, {{72, 24, 24}, 16}, {{84, 28, 28}, 16}};
}

// ------------------------------------------------------------------ methods --

/// Still 50 times below the tolerance of CalculiX.
const char* const loose_static_solver =
    R"({"static": {"frames": 1, "tolerance": 1e-4}, "threads": 1})";
const char* const relaxation = R"({"until": "rest", "threads": 1})";
const char* const loose_relaxation = R"({"until": "rest", "tolerance": 1e-4, "threads": 1})";

/// The rows of the front of 2026-11-21: relaxation by explicit steps.
std::vector<WorkMethod> relaxed_methods(bool largest) {
  std::vector<WorkMesh> meshes = beam_meshes({3, 5, 8, 10, 14});
  if (largest) meshes.push_back(beam_mesh(20));
  const std::string gauss = R"({"element": "trilinear"})";
  return {
      {"tm-faure gauss2, explicit", "tm-faure", gauss, relaxation, meshes},
      {"tm-faure gauss2, explicit to 1e-4", "tm-faure", gauss, loose_relaxation, meshes},
      {"tm-faure exact, explicit", "tm-faure", R"({"quadrature": "exact"})", relaxation, meshes},
      {"mss-baudet, explicit", "mss-baudet", "{}", relaxation, meshes},
      {"mss-baudet corrected, explicit", "mss-baudet", R"({"correction": true})", relaxation,
       meshes}};
}

// -------------------------------------------------------------------- scenes --

constexpr double shear_height = 0.01, shear_plate = 3e-4;  // m, m^2

Json shear_scene(const WorkMesh& mesh, const WorkMethod& method) {
  constexpr double shear = 0.01;
  Json scene = box_scene(mesh, {0.03, shear_height, 0.01}, method,
                         {{"E", 1000}, {"nu", 0.499}, {"rho", 1000}});
  scene["constraints"] = {held("y0"),
                          {{"move", {{"translation", {shear * shear_height, 0, 0}}}},
                           {"ramp", 1},
                           {"where", {{"set", "y1"}}}}};
  scene["output"] =
      tables({{"name", "plate"}, {"fields", {"reaction"}}, {"where", {{"set", "y1"}}}});
  return scene;
}

// --------------------------------------------------------------------- cases --

/// The elements and solvers of the front of 2026-11-21, and graded meshes.
std::vector<CalculixMethod> calculix_of_beams(bool largest) {
  std::vector<CalculixMethod> methods{{"C3D8", "SPOOLES", beam_meshes({3, 5, 8, 10})},
                                      {"C3D8I", "SPOOLES", beam_meshes({1, 2, 3, 5, 8, 10})},
                                      {"C3D20R", "SPOOLES", beam_meshes({1, 2, 3, 4, 5, 6})},
                                      {"C3D8", "ITERATIVE CHOLESKY", beam_meshes({10, 14})},
                                      {"C3D8I", "ITERATIVE CHOLESKY", beam_meshes({10})},
                                      {"C3D20R", "ITERATIVE CHOLESKY", beam_meshes({5, 6})}};
  if (largest) {
    methods.push_back({"C3D8", "ITERATIVE CHOLESKY", beam_meshes({20})});
    methods.push_back({"C3D8I", "ITERATIVE CHOLESKY", beam_meshes({14, 20})});
    methods.push_back({"C3D20R", "ITERATIVE CHOLESKY", beam_meshes({8})});
  }
  for (const char* element : {"C3D8I", "C3D20R"})
    methods.push_back({element, "SPOOLES", {{{9, 3, 3}, 8}, {{12, 4, 4}, 8}, {{24, 6, 6}, 16}}});
  return methods;
}

WorkCase beam_case(const std::string& name, double reference, const std::string& source) {
  const Cantilever& what = cantilever(name);
  const auto scene = [&what](const WorkMesh& mesh, const WorkMethod& method) {
    return cantilever_scene(what, mesh, method);
  };
  return {"cantilever " + name, reference, source, scene, "tip displacement y [m]", 1, {}};
}

/// Methods whose limit is that of St Venant and Kirchhoff's law at finite strain.
std::vector<WorkMethod> solid_methods(bool largest) {
  std::vector<WorkMesh> meshes = beam_meshes({1, 2, 3, 4, 5, 8, 10, 14, 20});
  if (largest) meshes.push_back(beam_mesh(28));
  std::vector<WorkMethod> methods{static_method("tm-faure", "mean-gradient", meshes),
                                  static_method("tm-faure", "mean-gradient", graded_meshes()),
                                  static_method("tm-faure", "trilinear", meshes)};
  methods[1].name += ", graded";
  WorkMethod loose = methods[1];
  loose.name = "tm-faure mean-gradient, static to 1e-4, graded";
  loose.solver = loose_static_solver;
  loose.meshes.push_back({{56, 26, 20}, 24});
  methods.push_back(std::move(loose));
  return methods;
}

const char* const dolfinx = "DOLFINx on graded quadratic meshes, extrapolated; FreeFem++ agrees";

WorkCase quarter_load(bool largest) {
  WorkCase what = beam_case("A0.25", cantilever("A0.25").converged, dolfinx);
  what.methods = solid_methods(largest);
  for (WorkMethod& method : relaxed_methods(largest)) what.methods.push_back(std::move(method));
  what.methods.push_back(static_method("mss-golec", "", beam_meshes({3, 5, 8, 10, 14})));
  what.beside = calculix_of_beams(largest);
  return what;
}

/// So small that all laws agree.
WorkCase small_load(bool largest) {
  WorkCase what = beam_case("B", cantilever("B").converged, dolfinx);
  what.methods = solid_methods(largest);
  for (const char* model : {"hooke", "corotational", "neo-hookean"})
    what.methods.push_back(static_method(model, "mean-gradient", beam_meshes({3, 5, 10, 20})));
  for (WorkMethod& method : relaxed_methods(largest)) what.methods.push_back(std::move(method));
  what.methods.push_back(static_method("mss-golec", "", beam_meshes({3, 5, 8, 10, 14})));
  what.beside = calculix_of_beams(largest);
  return what;
}

WorkCase full_load() {
  WorkCase what = beam_case("A", -0.513,
                            "extrapolated along the smooth branch, +-0.0015 m: meshes do not "
                            "converge at this load, so errors below 0.3 % mean nothing");
  what.methods = {static_method("tm-faure", "mean-gradient", beam_meshes({1, 2, 3, 5, 8, 10})),
                  static_method("tm-faure", "trilinear", beam_meshes({3, 5, 8, 10, 20}))};
  what.beside = calculix_of_beams(false);
  return what;
}

WorkCase incompressible() {
  WorkCase what = beam_case("H0.499", cantilever("H0.499").converged,
                            "DOLFINx, Taylor-Hood elements on graded meshes, extrapolated");
  what.methods = {
      static_method("tm-faure", "mean-gradient", beam_meshes({1, 2, 3, 5, 8, 10, 14, 20})),
      static_method("tm-faure", "trilinear", beam_meshes({3, 5, 10, 20}))};
  what.beside = calculix_of_beams(false);
  return what;
}

WorkCase shear() {
  const std::vector<WorkMesh> meshes{{{6, 2, 2}},    {{12, 4, 4}},   {{18, 6, 6}},
                                     {{30, 10, 10}}, {{45, 15, 15}}, {{60, 20, 20}}};
  return {"shear of liver",
          3.048694,
          "DOLFINx, Taylor-Hood elements on graded meshes, extrapolated; FreeFem++ agrees",
          shear_scene,
          "plate reaction x [N]",
          1 / shear_plate,
          {static_method("tm-faure", "mean-gradient", meshes),
           static_method("tm-faure", "trilinear", meshes)},
          {{"C3D8", "SPOOLES", {meshes.begin(), meshes.begin() + 3}},
           {"C3D8I", "SPOOLES", {meshes.begin(), meshes.begin() + 3}},
           {"C3D20R", "SPOOLES", {meshes.begin(), meshes.begin() + 2}},
           {"C3D8I", "ITERATIVE CHOLESKY", {meshes[2]}}}};
}

/// One element in simple shear at a constant rate for 10 s, so little that the law is linear.
struct PowerLaw {
  static constexpr double stiffness = 861, exponent = 0.1138, rate = 0.67e-4, end = 10;

  static double stress() {
    return stiffness * rate * std::pow(end, 1 - exponent) / std::tgamma(2 - exponent);
  }
  static Json scene(const WorkMesh& mesh, const WorkMethod& method) {
    constexpr double side = 0.01;
    Json scene =
        box_scene(mesh, {side, side, side}, method,
                  {{"K", stiffness}, {"n", exponent}, {"lambda", 166444.3}, {"rho", 1000}});
    scene["constraints"] = {held("y0"),
                            {{"move", {{"translation", {rate * end * side, 0, 0}}}},
                             {"ramp", end},
                             {"where", {{"set", "y1"}}}}};
    scene["output"] =
        tables({{"name", "plate"}, {"fields", {"reaction"}}, {"where", {{"set", "y1"}}}});
    return scene;
  }
};

WorkCase power_law() {
  WorkCase what{"power law of liver, 10 s",
                PowerLaw::stress(),
                "the law itself, K r t^(1-n) / Gamma(2-n), of which the model has five "
                "relaxation times",
                PowerLaw::scene,
                "plate reaction x [N]",
                1e4,
                {}};
  for (const char* steps : {"30", "100", "300", "1000", "3000"})
    what.methods.push_back(
        {std::string("visco, ") + steps + " steps",
         "visco",
         "{}",
         std::string(R"({"end": 10, "threads": 1, "static": {"frames": )") + steps + "}}",
         {{{1, 1, 1}}}});
  return what;
}

WorkMethod stepped(const std::string& name, const std::string& members) {
  return {name,
          "tm-faure",
          R"({"element": "trilinear"})",
          R"({"end": 0.5, "threads": 1, )" + members + "}",
          {beam_mesh(5)}};
}

/// The integrators on one mesh, at half a second of its fall.
WorkCase dynamic() {
  WorkCase what = beam_case("A0.25", -0.2651348699,
                            "two other programs on the same mesh with 1e-5 s steps: the error is "
                            "that of the integrator");
  what.name = "cantilever A0.25, dynamic";
  what.methods = {stepped("symplectic-euler, auto", R"("integrator": "symplectic-euler")"),
                  stepped("velocity-verlet, auto", R"("integrator": "velocity-verlet")")};
  for (const char* dt : {"1e-3", "2.5e-4", "1e-4"})
    for (const std::string name : {"symplectic-euler", "velocity-verlet"})
      what.methods.push_back(
          stepped(name + " " + dt + " s", R"("integrator": ")" + name + R"(", "dt": )" + dt));
  for (const char* dt : {"0.05", "0.02", "0.01", "0.005", "0.002"})
    for (const std::string name : {"implicit-euler", "newmark"})
      what.methods.push_back(
          stepped(name + " " + dt + " s", R"("integrator": ")" + name + R"(", "dt": )" + dt));
  for (const char* dt : {"0.02", "0.005", "0.002"})
    what.methods.push_back(
        stepped(std::string("implicit-euler, 10 iterations ") + dt + " s",
                R"("integrator": "implicit-euler", "budget": {"iterations": 10}, "dt": )" +
                    std::string(dt)));
  for (const char* dt : {"1e-3", "5e-4", "2e-4"})
    what.methods.push_back(stepped(std::string("xpbd ") + dt + " s",
                                   R"("integrator": "xpbd", "dt": )" + std::string(dt)));
  for (const char* error : {"1e-2", "1e-3", "1e-4"})
    what.methods.push_back(
        stepped(std::string("newmark, step error ") + error,
                R"("integrator": "newmark", "dt": "auto", "step_error": )" + std::string(error)));
  return what;
}

}  // namespace

std::vector<WorkCase> work_cases(bool largest) {
  return {quarter_load(largest),
          small_load(largest),
          full_load(),
          incompressible(),
          shear(),
          twist_case(),
          membrane_case(),
          slit_case(),
          organ_case(),
          power_law(),
          dynamic()};
}

}  // namespace suture::bench
