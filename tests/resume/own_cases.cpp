// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cases for which the stability suite has no scenes.
#include "kernel/mesh/box.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/resume/cases.hpp"

namespace suture::test {
namespace {

/// A bar of 1 m between two fixed ends, of a stiffness that takes 1,000 to 3,000 steps.
Case bar(const char* name, Random& random, std::array<int, 3> cells = {12, 3, 3}) {
  Case result{name, Json::parse(R"({
    "suture": 1, "mesh": {"box": {"size": [1, 0.25, 0.25], "cells": [12, 3, 3]}},
    "models": [{"model": "tm-faure", "parameters": {"E": 1e5, "nu": 0.3, "rho": 1000}}],
    "gravity": [0, -2, 0],
    "constraints": [{"where": {"set": "x0"}, "fix": "xyz"}, {"where": {"set": "x1"}, "fix": "xyz"}],
    "solver": {"end": 2}})")};
  result.scene["mesh"]["box"]["cells"] = cells;
  if (random.chance(0.5)) result.scene["solver"]["integrator"] = "velocity-verlet";
  result.skips = random.chance(0.7);
  return result;
}

Json across(double x, Random& random) {
  return {{"plane", {{"point", {x, 0, 0}}, {"normal", {1, random.between(-0.2, 0.2), 0}}}}};
}

Json rising_floor(Random& random, double end) {
  return {{"name", "floor"},
          {"half_space", {{"point", {0, -0.001, 0}}, {"normal", {0, 1, 0}}}},
          {"path",
           {{{"at", end * random.between(0.4, 0.95)}},
            {{"at", end}, {"translation", {0, random.between(-0.05, 0.05), 0}}}}}};
}

Case asleep(Random& random, unsigned, std::uint64_t) {
  Case result = bar("asleep", random);
  Json& scene = result.scene;
  scene["solver"]["damping"] = random.between(3, 20);
  scene["solver"]["end"] = 3;
  scene["solver"]["sleep"] = {{"acceleration", random.decades(1e-3, 0.3)},
                              {"velocity", random.decades(1e-4, 0.03)}};
  scene["events"] = {{{"at", 0.1}, {"cut", across(random.between(0.2, 0.8), random)}}};
  if (random.chance(0.5)) scene["gravity"] = {{"value", {0, -2, 0}}, {"ramp", 0.3}};
  if (random.chance(0.6))  // wakes one, or comes before it sleeps
    scene["events"].push_back(
        {{"at", random.between(0.2, 2.9)}, {"cut", across(random.between(0.2, 0.8), random)}});
  if (random.chance(0.3)) scene["events"].push_back({{"at", 2.5}, {"suture", Json::object()}});
  if (random.chance(0.5))
    scene["contact"] = {{"pieces", random.chance(0.7)},
                        {"obstacles", Json::array({rising_floor(random, 2.6)})}};
  add_output(scene, random);
  return result;
}

/// One end is moved in phases.
Case phases(Random& random, unsigned, std::uint64_t) {
  Case result = bar("phases", random);
  Json& scene = result.scene;
  Json stations = {{{"at", random.between(0, 0.3)}}};
  for (int i = 1; i < 6; ++i)
    stations.push_back({{"at", 0.3 * i + random.between(0.1, 0.3)},
                        {"translation", {random.between(0, 0.1), random.between(-0.05, 0.05), 0}},
                        {"angle", random.between(-20, 20)}});
  const char* const shapes[] = {"linear", "smooth", "cubic"};
  scene["constraints"][1] = {{"where", {{"set", "x1"}}},
                             {"move",
                              {{"path", stations},
                               {"rotation", {{"axis", {1, 0, 0}}, {"centre", {1, 0.1, 0.1}}}},
                               {"shape", shapes[static_cast<int>(random.between(0, 2.999))]}}}};
  scene["events"] = {{{"at", random.between(0.2, 1.5)}, {"cut", across(0.5, random)}}};
  const double scheme = random.between(0, 1);
  if (scheme < 0.3)
    scene["solver"].update({{"integrator", "newmark"}, {"dt", 0.02}});
  else if (scheme < 0.5)
    scene["solver"].update(
        {{"integrator", "implicit-euler"}, {"dt", 0.02}, {"budget", {{"iterations", 3}}}});
  else if (scheme < 0.7)
    scene["solver"].update({{"integrator", "xpbd"}, {"dt", 1e-3}});
  add_output(scene, random);
  return result;
}

Case kicked(Random& random, unsigned, std::uint64_t) {
  Case result = bar("kicked", random, {10, 2, 2});
  Json& scene = result.scene;
  scene["mesh"]["box"]["size"] = {1, 0.1, 0.1};
  scene["models"][0]["parameters"]["E"] = 1e6;
  scene["constraints"].erase(1);
  scene.erase("gravity");
  scene["loads"] = {
      {{"traction", {-random.between(1e4, 2e4), 0, 0}}, {"where", {{"set", "x1"}}}, {"ramp", 0.3}}};
  scene["solver"].erase("end");
  scene["solver"]["until"] = "rest";
  scene["solver"]["tolerance"] = 1e-4;
  if (random.chance(0.7)) scene["solver"]["kick"] = 1e-4;
  add_output(scene, random);
  return result;
}

Json lattice(double viscosity) {
  return {{{"model", "mss-baudet"},
           {"parameters", {{"E", 1e5}, {"nu", 0.3}, {"rho", 1000}, {"viscosity", viscosity}}}}};
}

Case springs(Random& random, unsigned, std::uint64_t) {
  Case result = bar("springs", random, {12, 3, 3});
  Json& scene = result.scene;
  scene["models"] = lattice(1);
  scene["events"] = {{{"at", random.between(0.1, 1.5)}, {"cut", across(0.4, random)}}};
  if (random.chance(0.5))
    scene["events"].push_back(
        {{"every", 3}, {"tear", {{"by", "elongation"}, {"above", random.between(0.03, 0.1)}}}});
  add_output(scene, random);
  scene["output"]["springs"] = true;
  return result;
}

/// Cuts along the blade: elements appear.
Case along(Random& random, unsigned, std::uint64_t) {
  Case result = bar("along", random, {10, 3, 3});
  Json& scene = result.scene;
  if (random.chance(0.4)) scene["models"] = lattice(1);
  scene["solver"]["damping"] = random.between(0, 5);
  scene["solver"]["end"] = 1;
  scene["events"] = Json::array();
  for (int i = 0; i < 3; ++i) {
    Json cut = across(random.between(0.2, 0.8), random);
    cut["along"] = i > 0 || random.chance(0.5) ? "blade" : "faces";
    if (random.chance(0.3)) cut["plane"]["radius"] = random.between(0.1, 0.3);
    scene["events"].push_back({{"at", random.between(0.05, 0.95)}, {"cut", cut}});
  }
  if (random.chance(0.4))
    scene["events"].push_back({{"at", random.between(0.05, 0.95)}, {"suture", Json::object()}});
  if (random.chance(0.4))
    scene["events"].push_back({{"at", random.between(0.05, 0.95)}, {"cut", across(0.4, random)}});
  if (random.chance(0.4))
    scene["events"].push_back(
        {{"at", random.between(0.05, 0.95)},
         {"pierce", {{"path", {{0.3, -2, 0.1}, {0.3, 2, 0.1}}}, {"radius", 0.06}}}});
  if (random.chance(0.4))
    scene["events"].push_back(
        {{"every", 3}, {"tear", {{"by", "elongation"}, {"above", random.between(0.03, 0.1)}}}});
  if (random.chance(0.5))
    scene["loads"] = {{{"where", {{"set", "y1"}}}, {"pressure", random.between(10, 1000)}},
                      {{"where", {{"set", "x1"}}}, {"traction", {0, 0, random.between(10, 200)}}}};
  if (random.chance(0.3)) scene["solver"]["sleep"] = {{"acceleration", 0.1}, {"velocity", 0.01}};
  if (random.chance(0.3))
    scene["solver"].update({{"integrator", "newmark"}, {"dt", 0.02}});
  else if (random.chance(0.7))
    scene["contact"] = {{"friction", random.between(0, 0.5)},
                        {"obstacles", Json::array({rising_floor(random, 1)})}};
  if (scene.contains("contact") && !scene["solver"].contains("sleep"))
    scene["contact"]["pieces"] = random.chance(0.6);
  if (scene.contains("contact") && random.chance(0.5)) {
    scene["contact"]["obstacles"].push_back(
        {{"name", "knife"},
         {"box", {{"min", {0.58, 0.35, -1}}, {"max", {0.62, 0.5, 1}}}},
         {"path", {{{"at", 0.1}}, {{"at", 0.9}, {"translation", {0.05, -0.4, 0}}}}}});
    scene["events"].push_back(
        {{"cut",
          {{"blade", {{"obstacle", "knife"}, {"points", {{0.6, 0.3, -1}, {0.61, 0.3, 1}}}}},
           {"along", "blade"}}}});
    if (!scene["solver"].contains("sleep") && random.chance(0.5))
      scene["events"].back()["cut"]["blade"]["resistance"] = {{"toughness", random.between(1, 50)}};
    if (random.chance(0.5))
      scene["contact"]["obstacles"].back()["coupling"] = {{"mass", random.decades(0.1, 100)},
                                                          {"stiffness", random.decades(1e3, 1e5)}};
  }
  add_output(scene, random);
  scene["output"]["surface"] = random.chance(0.5);
  return result;
}

Case when(Random& random, unsigned, std::uint64_t) {
  Case result = bar("when", random);
  Json& scene = result.scene;
  scene["events"] = {
      {{"when",
        {{"where", {{"nearest", {0.5, 0, 0}}}},
         {"of", "displacement"},
         {"component", "y"},
         {"below", -random.between(0.005, 0.03)}}},
       {"cut", across(0.5, random)}},
      {{"when", {{"where", {{"set", "y1"}}}, {"of", "velocity"}, {"above", 0.1}, {"every", 3}}},
       {"pierce", {{"path", {{0.3, -2, 0.1}, {0.3, 2, 0.1}}}, {"radius", 0.06}}}},
      {{"at", random.between(0.8, 1.8)}, {"suture", Json::object()}},
      {{"every", 7}, {"remove_islands", {{"below", 3}}}}};
  add_output(scene, random);
  return result;
}

void add_plugin(Json& scene, const char* name, Json parameters) {
  scene["plugins"] = {std::string(TEST_PLUGINS "/") + name + ".so"};
  scene["models"].push_back({{"model", name}, {"parameters", std::move(parameters)}});
}

/// Steps are rejected for a while.
Case moody(Random& random, unsigned, std::uint64_t) {
  Case result = bar("moody", random, {6, 2, 2});
  Json& scene = result.scene;
  const double from = random.between(0.05, 1), dt = 3e-3;  // about 5e-3
  if (random.chance(0.4)) scene["solver"]["dt"] = dt;
  add_plugin(scene, "moody",
             {{"how", random.pick(std::vector<std::string>{"retry", "retry", "nan"})},
              {"from", from},
              {"to", from + random.between(0.01, 0.1)},
              {"longest", random.between(0.1, 0.9) * dt},
              {"factor", random.pick(std::vector<double>{0.5, 0.25, 0.9})}});
  if (random.chance(0.5))
    scene["events"] = {{{"at", random.between(0.5, 1) * from}, {"cut", across(0.4, random)}}};
  if (random.chance(0.3))
    scene["events"].push_back(
        {{"every", 2}, {"tear", {{"by", "principal-strain"}, {"above", 0.01}, {"most", 1}}}});
  scene["solver"]["end"] = 4;
  add_output(scene, random);
  return result;
}

Case memory(Random& random, unsigned, std::uint64_t) {
  Case result = bar("memory", random, {6, 2, 2});
  Json& scene = result.scene;
  add_plugin(scene, "memory", {{"k", random.decades(1, 1e3)}, {"r", random.decades(0.1, 10)}});
  if (random.chance(0.6))
    scene["events"] = {{{"at", random.between(0.1, 2)}, {"cut", across(0.4, random)}}};
  if (random.chance(0.3))
    scene["events"].push_back({{"at", random.between(2, 3)}, {"suture", Json::object()}});
  scene["solver"]["end"] = 4;
  add_output(scene, random);
  return result;
}

/// Enough for several threads.
Case large(Random& random, unsigned index, std::uint64_t) {
  Case result = bar("large", random, {40, 11, 11});
  result.skips = true;
  Json& scene = result.scene;
  scene["solver"]["end"] = 0.4;
  switch (index % 3) {
    case 0:
      scene["events"] = {{{"at", random.between(0.1, 0.3)}, {"cut", across(0.5, random)}}};
      break;
    case 1:
      scene["events"] = {
          {{"cut",
            {{"blade",
              {{"path",
                {{{"at", 0.1}, {"points", {{0.45, 0.3, -1}, {0.5, 0.3, 1}}}},
                 {{"at", 0.3}, {"points", {{0.45, -0.1, -1}, {0.5, -0.1, 1}}}}}}}}}}}};
      break;
    default:
      scene["events"] = {
          {{"at", 0.15}, {"pierce", {{"path", {{0.3, -2, 0.1}, {0.3, 2, 0.1}}}, {"radius", 0.05}}}},
          {{"at", 0.1}, {"cut", across(0.7, random)}},
          {{"at", 0.3}, {"suture", Json::object()}}};
  }
  add_output(scene, random);
  scene["output"].erase("probes");
  scene["output"]["every_steps"] = 100;
  return result;
}

/// A row of every step, a frame of nearly every step.
Case dense(Random& random, unsigned, std::uint64_t) {
  Case result = bar("dense", random, {6, 2, 2});
  Json& scene = result.scene;
  scene["events"] = {{{"at", random.between(0.1, 1)}, {"cut", across(0.4, random)}}};
  scene["loads"] = {{{"where", {{"set", "y1"}}}, {"pressure", random.between(10, 1000)}}};
  add_output(scene, random);
  scene["output"].erase("every_steps");
  scene["output"]["every"] = random.decades(0.005, 0.02);
  scene["output"]["energies"]["every_steps"] = 1;
  return result;
}

/// Steps that solve equations; a cut between two of them, after which a piece may float free. The
/// multigrid is slow for springs.
Case implicit(Random& random, unsigned index, std::uint64_t) {
  Case result = bar("implicit", random, {16, 5, 5});
  Json& scene = result.scene;
  if (random.chance(0.5)) scene["models"] = lattice(0);
  scene["solver"] = {{"end", 1}};
  if (index % 3 == 0) {
    scene["solver"]["static"] = {{"frames", 30}};
    scene["gravity"] = {{"value", {0, -random.decades(2, 20), 0}}, {"ramp", {{"to", 1}}}};
    if (index % 2 == 0) {
      scene["constraints"].erase(1);
      scene["solver"]["static"]["free_pieces"] = "hold";
    } else {
      scene["solver"]["static"]["path"] = "arc-length";
    }
  } else {
    scene["solver"]["integrator"] = index % 3 == 1 ? "newmark" : "implicit-euler";
    scene["solver"]["dt"] = random.between(0.005, 0.03);
  }
  scene["events"] = {{{"at", random.between(0.1, 0.9)}, {"cut", across(0.4, random)}}};
  add_output(scene, random);
  scene["output"]["every_steps"] = 3;
  return result;
}

/// Implicit steps that fail and are tried again: Newton's method finds no solution, or a model
/// wants a smaller step.
Case retried(Random& random, unsigned index, std::uint64_t) {
  Case result = bar("retried", random, {6, 2, 2});
  Json& scene = result.scene;
  scene["solver"] = {{"end", 1}, {"integrator", "newmark"}, {"on_inversion", "warn"}};
  if (index % 2 == 0) {
    scene["solver"]["dt"] = 0.1;
    scene["gravity"] = {0, -300, 0};
    scene["constraints"].erase(1);
  } else {
    const double dt = random.between(0.01, 0.03), from = random.between(0.1, 0.7);
    scene["solver"]["dt"] = dt;
    if (random.chance(0.5)) scene["solver"]["integrator"] = "implicit-euler";
    add_plugin(scene, "moody",
               {{"how", random.pick(std::vector<std::string>{"retry", "nan"})},
                {"from", from},
                {"to", from + 4 * dt},
                {"longest", random.between(0.3, 0.9) * dt}});
  }
  scene["events"] = {{{"at", random.between(0.7, 0.9)}, {"cut", across(0.4, random)}}};
  add_output(scene, random);
  scene["output"]["every_steps"] = 2;
  result.reports = "tried again";
  return result;
}

/// Steps that follow their error, rejected ones among them, of a body with a memory.
Case adaptive(Random& random, unsigned index, std::uint64_t seed) {
  Case result = memory(random, index, seed);
  result.name = "adaptive";
  const bool implicit = index % 2 == 0;
  result.scene["solver"] = {{"end", 4},
                            {"integrator", implicit ? "newmark" : "velocity-verlet"},
                            {"step_error", implicit ? random.decades(1e-4, 1e-2) : 1e-6}};
  return result;
}

/// Parameters from arrays of the mesh and from tables.
Case varied(Random& random, unsigned index, std::uint64_t) {
  Case result = bar("varied", random);
  Mesh mesh = make_box({.size = {1, 0.25, 0.25}, .cells = {12, 3, 3}});
  mesh.arrays = {{"modulus", true, 1, {}, {}}, {"density", false, 1, {}, {}}};
  for (std::size_t e = 0; e < mesh.hexahedra.size(); ++e)
    mesh.arrays[0].values.push_back(random.decades(3e4, 3e5));
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
    mesh.arrays[1].values.push_back(random.between(500, 2000));
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  write_mesh(folder / "bar.vtk", mesh, diagnostics);
  result.files["bar.vtk"] = read_text(folder / "bar.vtk");
  Json& scene = result.scene;
  scene["mesh"] = {{"file", "bar.vtk"}};
  Json& parameters = scene["models"][0]["parameters"];
  parameters["E"] = {{"array", "modulus"}};
  parameters["rho"] = {{"array", "density"}};
  if (index % 2 == 0)
    scene["models"][0]["model"] = "mss-baudet";
  else
    parameters["nu"] = {{"regions", {{{"region", {{"ids", {1, 2, 3}}}}, {"value", 0.1}}}},
                        {"elsewhere", 0.3}};
  scene["events"] = {{{"at", random.between(0.1, 1)}, {"cut", across(0.5, random)}},
                     {{"at", random.between(1, 1.5)},
                      {"pierce", {{"path", {{0.3, -2, 0.1}, {0.3, 2, 0.1}}}, {"radius", 0.06}}}}};
  add_output(scene, random);
  return result;
}

/// A slab that falls onto a table, is pushed by a ball, which may be compliant and carry a blade,
/// and is cut there; sometimes in implicit steps.
Case obstacles(Random& random, unsigned, std::uint64_t) {
  Case result = bar("obstacles", random);
  Json& scene = result.scene;
  scene.erase("constraints");
  scene["gravity"] = {1, 0, -9.81};
  scene["contact"] = {
      {"friction", random.between(0, 0.5)},
      {"pieces", random.chance(0.7)},
      {"obstacles",
       {{{"name", "table"}, {"half_space", {{"point", {0, 0, -0.01}}, {"normal", {0, 0, 1}}}}},
        {{"name", "ball"},
         {"sphere", {{"centre", {0.5, 0.1, 0.36}}, {"radius", 0.1}}},
         {"path",
          {{{"at", 0.1}}, {{"at", random.between(0.3, 1)}, {"translation", {0.1, 0, -0.08}}}}}}}}};
  scene["events"] = {{{"at", random.between(0.1, 1)}, {"cut", across(0.5, random)}},
                     {{"at", random.between(1, 1.5)},
                      {"pierce", {{"path", {{0.3, 0.1, -2}, {0.3, 0.1, 2}}}, {"radius", 0.06}}}}};
  if (scene["contact"]["pieces"]) scene["contact"]["self"] = random.chance(0.5);
  if (random.chance(0.5))
    scene["contact"]["obstacles"][1]["coupling"] = {{"mass", random.decades(0.1, 100)},
                                                    {"stiffness", random.decades(1e3, 1e5)}};
  if (random.chance(0.5))
    scene["events"].push_back(
        {{"cut",
          {{"blade", {{"obstacle", "ball"}, {"points", {{0.47, -1, 0.2}, {0.47, 1, 0.2}}}}}}}});
  if (random.chance(0.2)) {
    scene["contact"].update({{"law", "penalty"}, {"friction", 0}, {"pieces", false}});
    scene["contact"].erase("self");
    scene["contact"]["obstacles"][1].erase("coupling");
  }
  if (random.chance(0.2)) {
    scene["contact"].erase("law");
    scene["contact"]["obstacles"][1].erase("coupling");
    scene["solver"]["integrator"] = "implicit-euler";
    scene["solver"]["dt"] = random.between(0.01, 0.03);
  }
  add_output(scene, random);
  scene["output"]["tools"]["every_steps"] = 1 + static_cast<int>(random.decades(1, 30));
  scene["output"]["fields"].push_back("contact_force");
  return result;
}

/// An octahedron that its surface fills: it falls onto a table, is pressed, cut and pierced there.
Case filled(Random& random, unsigned, std::uint64_t) {
  Case result = bar("filled", random);
  result.files["octahedron.obj"] =
      "v 0.3 0 0\nv -0.3 0 0\nv 0 0.3 0\nv 0 -0.3 0\nv 0 0 0.3\nv 0 0 -0.3\n"
      "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";
  Json& scene = result.scene;
  scene["mesh"] = {{"surface", "octahedron.obj"},
                   {"cells", static_cast<int>(random.between(100, 400))}};
  scene.erase("constraints");
  scene["gravity"] = {0.5, 0, -9.81};
  scene["solver"]["end"] = 1;
  scene["solver"]["damping"] = random.between(0, 5);
  scene["contact"] = {
      {"friction", random.between(0, 0.5)},
      {"obstacles",
       {{{"name", "table"}, {"half_space", {{"point", {0, 0, -0.31}}, {"normal", {0, 0, 1}}}}}}}};
  scene["loads"] = {{{"pressure", 500},
                     {"where", {{"half_space", {{"point", {0, 0, 0.05}}, {"normal", {0, 0, 1}}}}}}},
                    {{"traction", {20, 0, 0}},
                     {"where", {{"sphere", {{"centre", {0, 0, 0}}, {"radius", 0.4}}}}}}};
  scene["events"] = {{{"at", random.between(0.1, 0.5)}, {"cut", across(0.02, random)}},
                     {{"at", random.between(0.5, 0.8)},
                      {"pierce", {{"path", {{0.1, 0.05, -2}, {0.1, 0.05, 2}}}, {"radius", 0.06}}}}};
  if (random.chance(0.3)) {
    scene["contact"].update({{"law", "penalty"}, {"friction", 0}});
  } else if (random.chance(0.3)) {
    scene["solver"].update({{"integrator", "implicit-euler"}, {"dt", 0.02}});
  }
  add_output(scene, random);
  scene["output"]["surface"] = true;
  scene["output"]["fields"].push_back("contact_force");
  return result;
}

}  // namespace

std::vector<Kind> own_kinds() {
  return {{"asleep", 2, 12, asleep},    {"kicked", 1, 8, kicked}, {"springs", 1, 8, springs},
          {"when", 1, 8, when},         {"moody", 2, 16, moody},  {"memory", 1, 10, memory},
          {"large", 1, 9, large},       {"dense", 1, 8, dense},   {"implicit", 3, 9, implicit},
          {"adaptive", 2, 8, adaptive}, {"varied", 2, 8, varied}, {"obstacles", 2, 8, obstacles},
          {"retried", 2, 8, retried},   {"phases", 1, 8, phases}, {"filled", 2, 8, filled},
          {"along", 2, 12, along}};
}

}  // namespace suture::test
