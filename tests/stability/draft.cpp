// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/draft.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "kernel/build/built_scene.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/stability/runner.hpp"

namespace suture::test {

// ------------------------------------------------------------------ numbers --

namespace {

std::uint64_t mixed(std::uint64_t x) {  // splitmix64
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

}  // namespace

Random::Random(std::uint64_t seed, std::string_view family, unsigned index) : state_(seed) {
  for (const char c : family) state_ = mixed(state_ ^ static_cast<unsigned char>(c));
  state_ = mixed(state_ ^ index);
}

double Random::number() {
  state_ += 0x9e3779b97f4a7c15u;
  return static_cast<double>(mixed(state_) >> 11) * 0x1p-53;
}

double Random::decades(double low, double high) {
  return std::pow(10, between(std::log10(low), std::log10(high)));
}

// ------------------------------------------------------------------- bodies --

namespace {

struct Shape {
  const char* name;
  std::array<double, 3> size;
  std::array<int, 3> cells;
  bool is_of_cubes;
};

// Lengths in edges of a cube.
constexpr Shape shapes[] = {
    {"single", {1, 1, 1}, {1, 1, 1}, true},      {"bar", {8, 2, 2}, {8, 2, 2}, true},
    {"thick-bar", {12, 4, 4}, {12, 4, 4}, true}, {"slab", {6, 1, 6}, {6, 1, 6}, true},
    {"block", {4, 4, 4}, {4, 4, 4}, true},       {"corner", {6, 4, 2}, {6, 4, 2}, true},
    {"graded", {13.6, 2, 2}, {10, 2, 2}, false}, {"flat", {4, 0.4, 4}, {4, 2, 4}, false},
    {"sheared", {6, 2, 2}, {6, 2, 2}, false},    {"general", {5, 3, 3}, {5, 3, 3}, false}};

/// A grid whose inner points are moved, in Medit's format; x = 0 and x = L stay planes.
std::string warped_grid(const Shape& shape, double unit, bool sheared, Random& random) {
  const auto [nx, ny, nz] = shape.cells;
  char line[200];
  const auto id = [nx = nx, ny = ny](int i, int j, int k) {
    return 1 + i + (nx + 1) * (j + (ny + 1) * k);
  };
  std::string text = "MeshVersionFormatted 2\nDimension 3\nVertices\n" +
                     std::to_string((nx + 1) * (ny + 1) * (nz + 1)) + "\n";
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i) {
        std::array<double, 3> x{1.0 * i, 1.0 * j, 1.0 * k};
        if (sheared) {
          x[1] += 0.5 * k;
        } else {
          const double taper = 1 - 0.3 * i / nx;
          const bool inner = i > 0 && i < nx && j > 0 && j < ny && k > 0 && k < nz;
          for (double& c : x) c += inner ? random.between(-0.15, 0.15) : 0;
          x[1] = ny / 2.0 + taper * (x[1] - ny / 2.0);
          x[2] = nz / 2.0 + taper * (x[2] - nz / 2.0);
        }
        std::snprintf(line, sizeof line, "%.17g %.17g %.17g 0\n", unit * x[0], unit * x[1],
                      unit * x[2]);
        text += line;
      }
  text += "Hexahedra\n" + std::to_string(nx * ny * nz) + "\n";
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        std::snprintf(line, sizeof line, "%d %d %d %d %d %d %d %d 0\n", id(i, j, k),
                      id(i + 1, j, k), id(i + 1, j + 1, k), id(i, j + 1, k), id(i, j, k + 1),
                      id(i + 1, j, k + 1), id(i + 1, j + 1, k + 1), id(i, j + 1, k + 1));
        text += line;
      }
  return text + "End\n";
}

}  // namespace

Body make_body(const std::string& name, double scale, Random& random) {
  const Shape& shape = *std::ranges::find(shapes, name, &Shape::name);
  Body body;
  body.name = name;
  body.cells = shape.cells;
  body.scale = scale;
  body.is_of_cubes = shape.is_of_cubes;
  const double unit = scale / *std::ranges::max_element(shape.size);
  for (std::size_t a = 0; a < 3; ++a) body.size[a] = unit * shape.size[a];
  if (name == "corner") {
    body.mesh["voxels"] = {
        {"size", unit}, {"rows", {"AA....", "AA....", "AAAAAA", "AAAAAA"}}, {"layers", 2}};
  } else if (name == "sheared" || name == "general") {
    body.file = warped_grid(shape, unit, name == "sheared", random);
    body.mesh["file"] = "mesh.mesh";
  } else {
    body.mesh["box"] = {{"size", body.size}, {"cells", body.cells}};
    if (name == "graded") body.mesh["box"]["grading"] = {20, 1, 1};
  }
  return body;
}

// ------------------------------------------------------------------- drafts --

namespace {

const std::vector<double> all_nus{0, 0.1, 0.25, 0.3, 0.45, 0.49, 0.499};
const std::vector<double> all_youngs{1e3, 3e3, 1e4, 1e5, 4e5, 1e6, 1e9};
constexpr double steps_of_run = 10'500;

std::vector<std::string> all_bodies() {
  std::vector<std::string> names;
  for (const Shape& shape : shapes) names.emplace_back(shape.name);
  return names;
}

}  // namespace

Draft::Draft(const Family& family, unsigned i, std::uint64_t seed)
    : index(i), random(seed, family.name, i) {
  trial.name = trial_name(family, i);
}

void Draft::choose(const std::vector<std::string>& bodies) { choose(bodies, all_nus); }

void Draft::choose(const std::vector<std::string>& bodies, const std::vector<double>& nus,
                   bool continuum_only) {
  const std::vector<std::string> names = bodies.empty() ? all_bodies() : bodies;
  const double scale = random.pick(std::vector<double>{1, 0.1, 0.3, 1, 1e-3, 1e-6, 1e3});
  body = make_body(names[index % names.size()], scale, random);
  trial.mesh = body.file;
  trial.probe = {0.6 * body.length(), body.height(), 0};
  trial.scene["suture"] = 1;
  trial.scene["mesh"] = body.mesh;
  choose_material(nus, continuum_only);
  trial.scene["solver"]["end"] = 1;
  find_stable_step();
}

void Draft::choose_material(const std::vector<double>& nus, bool continuum_only) {
  poisson = nus[(index / 2) % nus.size()];
  young =
      random.chance(0.06) ? random.pick(std::vector<double>{1e-3, 1e12}) : random.pick(all_youngs);
  density = random.pick(std::vector<double>{1000, 1000, 1000, 1, 1e4});
  is_springs_ = !continuum_only && body.is_of_cubes && random.chance(0.45);
  Json parameters{{"E", young}, {"nu", poisson}, {"rho", density}};
  std::string kind = "gauss2";
  if (is_springs_) {
    kind = random.pick(std::vector<std::string>{"plain", "correction", "viscosity"});
    if (kind == "correction") parameters[kind] = true;
    if (kind == "viscosity") parameters[kind] = 1;
    if (kind == "viscosity") trial.is_conservative = false;
  } else if (random.chance(0.25)) {
    kind = "exact";
    parameters["quadrature"] = "exact";
  }
  const char* model = is_springs_ ? "mss-baudet" : "tm-faure";
  trial.scene["models"] = {{{"model", model}, {"parameters", parameters}}};
  char text[200];
  std::snprintf(text, sizeof text, "%s %s %s of %g m nu %g E %g rho %g", model, kind.c_str(),
                body.name.c_str(), body.scale, poisson, young, density);
  trial.title = text;
}

double period_of(const Body& body, double young, double density) {
  return body.length() * std::sqrt(density / young);
}

void Draft::start(const Body& given, const Material& material, double end) {
  body = given;
  young = material.young;
  poisson = material.poisson;
  density = material.density;
  period_ = period_of(body, young, density);
  end_ = end * period_;
  trial.scene["suture"] = 1;
  trial.scene["mesh"] = body.mesh;
  trial.scene["models"] = Json::array({model_entry(material)});
  trial.scene["output"] = false;
}

void Draft::find_stable_step() {
  trial.stable = stable_step_of(trial);
  period_ = period_of(body, young, density);
  Json& solver = trial.scene["solver"];
  const bool verlet = index % 2 == 1, fixed = random.chance(0.25);
  solver["integrator"] = verlet ? "velocity-verlet" : "symplectic-euler";
  solver.erase("dt");
  if (fixed) solver["dt"] = 0.5 * trial.stable;
  end_ = steps_of_run * (fixed ? 0.5 : 0.8) * trial.stable;
  solver["end"] = end_;
  solver["threads"] = 1;
  trial.scene["output"] = false;
  note(verlet ? "verlet" : "euler");
  note(fixed ? "fixed dt" : "auto");
}

Json Draft::x_end(int side) const {
  return {{"plane", {{"point", {side == 0 ? 0 : body.length(), 0, 0}}, {"normal", {1, 0, 0}}}}};
}

void Draft::fix(int side, const char* components) {
  trial.scene["constraints"].push_back({{"where", x_end(side)}, {"fix", components}});
}

namespace {

double ramp_end(const Json& ramp) {
  if (ramp.is_null()) return 0;
  return ramp.is_object() ? ramp["to"].get<double>() : ramp.get<double>();
}

}  // namespace

void Draft::move(int side, const Json& motion, const Json& ramp) {
  trial.scene["constraints"].push_back({{"where", x_end(side)}, {"move", motion}, {"ramp", ramp}});
  settle(ramp_end(ramp));
}

void Draft::load(const char* kind, const Json& value, const Json& ramp) {
  load_on(x_end(1), kind, value, ramp);
}

void Draft::load_on(const Json& where, const char* kind, const Json& value, const Json& ramp) {
  Json load{{"where", where}, {kind, value}};
  if (!ramp.is_null()) load["ramp"] = ramp;
  trial.scene["loads"].push_back(load);
  settle(ramp_end(ramp));
  if (std::string(kind) == "pressure") trial.is_conservative = false;
}

void Draft::gravity(int axis, double gamma, bool sudden) {
  std::array<double, 3> g{};
  g[static_cast<std::size_t>(axis)] = gamma * young / (density * body.length());
  if (sudden) {
    trial.scene["gravity"] = g;
  } else {
    const Json ramp = slow_ramp();
    trial.scene["gravity"] = {{"value", g}, {"ramp", ramp}};
    settle(ramp_end(ramp));
  }
  char text[60];
  std::snprintf(text, sizeof text, "gamma %.3g %s", gamma, sudden ? "sudden" : "ramped");
  note(text);
}

void Draft::event(double time, Json operation) {
  operation["at"] = time;
  trial.scene["events"].push_back(operation);
  trial.is_smooth = false;
  settle(time);
}

Json Draft::slow_ramp() {
  const double to = std::min(random.between(5, 20) * period_, 0.3 * end_);
  trial.is_smooth = to >= 5 * period_;
  if (random.chance(0.5)) return to;
  return {{"from", 0}, {"to", to}, {"shape", "smooth"}};
}

double stable_step_of(const Trial& trial) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  BuiltScene built(read_trial(trial, folder.path()), diagnostics);
  built.dynamics().start();
  return built.limits().stable_step(0, true);
}

}  // namespace suture::test
