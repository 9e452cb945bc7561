// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture/model_templates.hpp"

namespace suture {
namespace {

// Models for users, under the licence of the SDK.
constexpr std::string_view law = R"model(// SPDX-License-Identifier: MIT
#include "suture/continuum.hpp"

struct @Struct@ : suture::continuum<@Struct@> {
  static constexpr const char *id = "@id@", *doc = "Compressible neo-Hookean solid",
                              *formula = "W = mu/2 (F:F - 3) - mu ln J + lambda/2 (ln J)^2",
                              *citation = "Bonet, Wood: Nonlinear Continuum Mechanics, 2008, 6.27";
  enum { mu, lambda, rho };
  static constexpr suture::parameter parameters[] = {
      suture::number("mu", "Pa", "Shear modulus").above(0),
      suture::number("lambda", "Pa", "First Lame constant").at_least(0),
      suture::number("rho", "kg/m^3", "Density").above(0)};
  static double density(const suture::values& p) { return p[rho]; }

  template <class T, class Parameters>
  static SUTURE_INLINE T energy(const suture::mat3<T>& F, const Parameters& p) {
    const T ln_j = log1p(excess_J(F));  // the excess of J is J - 1, that of I1 is I1 - 3
    return 0.5 * p[mu] * (excess_I1(F) - 2.0 * ln_j) + 0.5 * p[lambda] * ln_j * ln_j;
  }
};
SUTURE_PLUGIN("@id@", "1.0", "MIT", "Neo-Hookean solid", @Struct@)
)model";

constexpr std::string_view springs = R"model(// SPDX-License-Identifier: MIT
#include "suture/model.hpp"

/// Springs along the edges of the elements. What elements contribute to an edge is summed, at the
/// start and after every cut.
struct @Struct@ : suture::model, suture::on_edges {
  static constexpr const char *id = "@id@", *doc = "Springs along edges",
                              *formula = "f = k (l/L - 1) u, k = sum of E V / (4 L)",
                              *citation = "textbook";
  enum { young, rho };
  static constexpr suture::parameter parameters[] = {
      suture::number("E", "Pa", "Stiffness").above(0),
      suture::number("rho", "kg/m^3", "Density").above(0)};

  template <class Cell>
  static auto volume(const Cell& c) {
    return dot(c.rest(1) - c.rest(0), cross(c.rest(2) - c.rest(0), c.rest(4) - c.rest(0)));
  }
  struct MassOfNodes {
    static constexpr int components = 1;
    template <class Cell, class Out>
    static void compute(const Cell& c, Out out) {
      for (int n = 0; n < 8; ++n) out.set(n, 0, c.parameter(rho) * volume(c) / 8.0);
    }
  };
  struct StiffnessOfEdges {
    static constexpr int components = 1;
    template <class Cell, class Out>
    static void compute(const Cell& c, Out out) {
      for (int e = 0; e < 12; ++e) {
        const auto* ends = suture_hexahedron_edges[e];
        const auto length = norm(c.rest(ends[1]) - c.rest(ends[0]));
        out.set(e, 0, c.parameter(young) * volume(c) / (4.0 * length));
      }
    }
  };
  static constexpr suture::attribute attributes[] = {
      suture::vertex_attribute("mass", "kg", "Mass of the nodes")
          .from_volumes(suture::contribution<@Struct@, MassOfNodes>)
          .flag(SUTURE_SHARED_MASS),
      suture::edge_attribute("stiffness", "N", "Stiffness k of an edge")
          .from_volumes(suture::contribution<@Struct@, StiffnessOfEdges>)};
  static constexpr suture::column<1> stiffness{};
  static constexpr auto cell_columns = suture::columns(stiffness);
  static constexpr auto reads = SUTURE_READ_REST | SUTURE_READ_POSITION;

  template <class Cell>
  static void force(const Cell& c) {
    const auto d = c.position(1) - c.position(0);
    const auto length = norm(d), strain = length / norm(c.rest(1) - c.rest(0)) - 1.0;
    const auto f = (c.column(stiffness) * strain / length) * d;
    c.force(0, f);
    c.force(1, -f);
  }
  template <class Cell>
  static auto energy(const Cell& c) {
    const auto rest = norm(c.rest(1) - c.rest(0));
    const auto strain = norm(c.position(1) - c.position(0)) / rest - 1.0;
    return 0.5 * c.column(stiffness) * rest * strain * strain;
  }
};
SUTURE_PLUGIN("@id@", "1.0", "MIT", "Springs along edges", @Struct@)
)model";

constexpr std::string_view diffusion = R"model(// SPDX-License-Identifier: MIT
#include "suture/diffusion.hpp"

/// A substance that spreads through the body. Laws on the same elements may read it.
struct @Struct@ : suture::model, suture::on_volumes {
  static constexpr const char *id = "@id@", *name = "diffusion", *doc = "Diffusion of a substance",
                              *formula = "dc/dt = div(D grad c)",
                              *citation = "A. Fick, Ann. Phys. 170, 1855, 59";
  enum { diffusivity };
  static constexpr suture::parameter parameters[] = {
      suture::number("D", "m^2/s", "Diffusivity").above(0)};
  static double capacity(const suture::values&) { return 1; }  // of a volume: moles per mol/m^3

  static constexpr suture::column<0> concentration{};
  static constexpr suture::attribute attributes[] = {
      suture::vertex_field("concentration", "mol/m^3", "Moles per volume"),
      suture::lumped_capacity<@Struct@>("volume", "m^3", "Volume of the nodes")};
  static constexpr auto reads = SUTURE_READ_REST;
  static constexpr auto rate_of = concentration;
  static constexpr auto vertex_columns = suture::columns(concentration);

  // What flows into each node per second: c.rate(node, ...), from c.field(node).
  template <class Cell>
  static void rate(const Cell& c) {
    suture::diffuse(c, c.parameter(diffusivity));
  }
};
SUTURE_PLUGIN("@id@", "1.0", "MIT", "Diffusion of a substance", @Struct@)
)model";

constexpr std::string_view cmake = R"(cmake_minimum_required(VERSION 3.25)
project(@id@ LANGUAGES C CXX)
find_package(Suture REQUIRED)
enable_testing()
# With the test @id@.check-model, which compares the model with laws of physics.
suture_add_plugin(@id@ SOURCES @file@)
add_test(NAME @id@.run COMMAND ${SUTURE_PROGRAM} run ${CMAKE_CURRENT_SOURCE_DIR}/scene.json
  --output ${CMAKE_CURRENT_BINARY_DIR}/out)
)";

constexpr std::string_view scene_of_model =
    R"(// A bar. Look at out/scene/run.pvd in ParaView.
{
  "suture": 2,
  "plugins": ["build/lib/suture/plugins/@id@.so"],
  "mesh": {"box": {"size": [0.4, 0.1, 0.1], "cells": [8, 2, 2]}},
  "models": [
    {"model": "@id@", "parameters": @parameters@}@solid@
  ],
@motion@
  "solver": {@integrator@"dt": "auto", "end": 1, "damping": 2},
  "output": {"every": 0.05, "fields": ["displacement", "velocity"]}
}
)";

constexpr std::string_view solid = R"(,
    {"model": "neo-hookean", "parameters": {"E": 1e4, "nu": 0.3, "rho": 1000}})";

// The two halves of the bar.
constexpr std::string_view two_halves = R"({"k": 1e7}, "between": [
      {"half_space": {"point": [0.2, 0, 0], "normal": [-1, 0, 0]}},
      {"half_space": {"point": [0.2, 0, 0], "normal": [1, 0, 0]}}]
    )";

constexpr std::string_view stretched = R"(  "constraints": [
    {"fix": "xyz", "where": {"set": "x0"}},
    {"move": {"translation": [0.1, 0, 0]}, "ramp": 0.5, "where": {"set": "x1"}}
  ],)";
constexpr std::string_view held = R"(  "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],)";
constexpr std::string_view falling = R"(  "gravity": [0, 0, -9.81],)";

constexpr std::string_view soaked = R"(  "constraints": [{"fix": "xyz", "where": {"set": "x0"}}],
  "fields": [{"field": "concentration", "fix": 1, "where": {"set": "x0"}}],)";

constexpr std::string_view readme = R"(# @id@

A model for Suture. `@file@` is the model, `scene.json` a scene that uses it.

    cmake -S . -B build && cmake --build build    # if Suture is elsewhere: -DCMAKE_PREFIX_PATH=...
    ctest --test-dir build --output-on-failure    # laws of physics, and a run of the scene
    suture run scene.json

`suture describe @id@` shows the parameters once `SUTURE_PLUGIN_PATH` names `build/lib/suture/plugins`.
)";

constexpr std::string_view ignored = R"(build/
out/
)";

constexpr std::string_view workflow =
    R"(# On GitHub: builds Suture and this model on Debian 12, and tests the model. The address of Suture's
# repository is your variable SUTURE (Settings, Secrets and variables, Actions, Variables).
on: [push, pull_request]
jobs:
  check:
    runs-on: ubuntu-latest
    container: debian:12
    steps:
      - uses: actions/checkout@v4
      - run: apt-get update && apt-get install -y git
      - run: git clone --depth 1 "${{ vars.SUTURE }}" /suture && /suture/dev build
      - run: cmake --install /suture/build --prefix /usr/local
      - run: cmake -S . -B build -DSUTURE_INSTRUCTION_SETS=base && cmake --build build
      - run: ctest --test-dir build --output-on-failure
)";

}  // namespace

std::span<const ModelLevel> model_levels() {
  static const ModelLevel levels[] = {
      {"law", "model.cpp", law, R"({"mu": 1e4, "lambda": 2e4, "rho": 1000})", "", stretched},
      {"springs", "model.cpp", springs, R"({"E": 1e4, "rho": 1000})", "", stretched},
      {"nodes", "model.cpp", templates::nodes, R"({"k": 100, "gap": 0.01, "c": 1})", solid,
       falling},
      {"faces", "model.cpp", templates::faces, R"({"p": 1000, "ramp": 0.5})", solid, held},
      {"field", "model.cpp", diffusion, R"({"D": 0.01})", solid, soaked},
      {"constraint", "model.cpp", templates::constraint, R"({"kappa": 1e5})", solid, stretched,
       R"("integrator": "xpbd", )"},
      {"lips", "model.cpp", templates::lips, two_halves, solid, stretched},
      {"batches", "model.cpp", templates::batches, R"({"c": 0.1})", solid, stretched},
      {"c", "model.c", templates::plain_c, R"({"k": 10, "c": 0.01})", solid, stretched}};
  return levels;
}

std::vector<TemplateFile> files_of(const ModelLevel& level) {
  return {{"CMakeLists.txt", cmake},  {"README.md", readme},
          {level.file, level.source}, {"scene.json", scene_of_model},
          {".gitignore", ignored},    {".github/workflows/check.yml", workflow}};
}

}  // namespace suture
