// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/suture-bench/contact_letters.hpp"

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <string>

#include "apps/suture-bench/body.hpp"
#include "apps/suture-bench/timer.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/forces/contact_law.hpp"
#include "kernel/run/simulation.hpp"

namespace suture::bench {
namespace {

using Letter = std::array<std::string_view, 5>;  ///< from the top; '#': a square
constexpr std::array<Letter, 5> darts{{{"##.", "#.#", "#.#", "#.#", "##."},
                                       {".#.", "#.#", "###", "#.#", "#.#"},
                                       {"##.", "#.#", "##.", "#.#", "#.#"},
                                       {"###", ".#.", ".#.", ".#.", ".#."},
                                       {"###", "#..", "###", "..#", "###"}}};
constexpr Index letters = 20, squares = 4, layers = 6;  // squares of 4 x 4 elements
constexpr double letter_edge = 0.02;                    // m
constexpr double half_width = 0.5;                      // m, of the box

/// Turned about the vertical and tilted a little.
struct Attitude {
  double turn, tilt;

  Vec3 operator()(const Vec3& p) const {
    const Vec3 tilted{p[0], std::cos(tilt) * p[1] - std::sin(tilt) * p[2],
                      std::sin(tilt) * p[1] + std::cos(tilt) * p[2]};
    return {std::cos(turn) * tilted[0] - std::sin(turn) * tilted[1],
            std::sin(turn) * tilted[0] + std::cos(turn) * tilted[1], tilted[2]};
  }
};

void add_letter(Mesh& mesh, const Letter& letter, const Vec3& centre, const Attitude& attitude) {
  std::map<std::array<Index, 3>, Index> nodes;
  const auto node = [&](Index i, Index j, Index k) {
    const auto [at, is_new] = nodes.try_emplace({i, j, k}, static_cast<Index>(mesh.points.size()));
    if (is_new)
      mesh.points.push_back(plus(
          centre,
          attitude(scaled(letter_edge, {i - 1.5 * squares, 2.5 * squares - j, k - layers / 2.}))));
    return at->second;
  };
  for (Index k = 0; k < layers; ++k)
    for (Index j = 0; j < 5 * squares; ++j)
      for (Index i = 0; i < 3 * squares; ++i) {
        if (letter[j / squares][i / squares] != '#') continue;
        Hexahedron& hexahedron = mesh.hexahedra.emplace_back();
        for (Index n = 0; n < 8; ++n)  // j runs down
          hexahedron[n] = node(i + (n & 1), j + 1 - (n >> 1 & 1), k + (n >> 2));
      }
}

/// Five layers of four.
Mesh stacked_letters() {
  std::mt19937 random(1);
  const auto jitter = [&] { return random() / 2147483648.0 - 1; };
  Mesh mesh;
  mesh.source = "20 letters";
  for (Index i = 0; i < letters; ++i) {
    const double x = 0.24 * (i % 2 ? 1 : -1), y = 0.24 * (i / 2 % 2 ? 1 : -1);
    const Vec3 centre{x + 0.02 * jitter(), y + 0.02 * jitter(), 0.12 + 0.2 * (i / 4)};
    const bool across = i / 4 % 2 == 1;
    add_letter(mesh, darts[i % 5], centre, {(across ? 1.57 : 0) + 0.1 * jitter(), 0.2 * jitter()});
  }
  return mesh;
}

Scene scene_of_letters(PluginHost& host, bool with_contact) {
  Scene scene;
  scene.mesh.given = std::make_shared<Mesh>(stacked_letters());
  ModelUse use;
  use.name = "tm-faure";
  use.model = &host.model(use.name);
  use.parameters = parameters_of(*use.model, {{"E", 1e6}, {"nu", 0.3}, {"rho", 200}});
  scene.models.push_back(use);
  scene.gravity = {0, 0, -9.81};
  scene.solver.damping = 1;
  scene.solver.end = 10;
  scene.solver.threads = 1;
  scene.output.enabled = false;
  if (!with_contact) return scene;
  scene.contact.pieces = true;
  scene.contact.friction = 0.3;
  const auto plane = [&](const Vec3& point, const Vec3& normal) {
    const std::string number = std::to_string(scene.contact.obstacles.size());
    scene.contact.obstacles.push_back({"plane-" + number,
                                       "/contact/obstacles/" + number,
                                       HalfSpace{point, scaled(1 / norm(normal), normal)},
                                       {},
                                       0.3});
  };
  plane({}, {0, 0, 1});
  for (const double side : {-1., 1.}) {
    plane({side * half_width, 0, 0}, {-side, 0, 0});
    plane({0, side * half_width, 0}, {0, -side, 0});
  }
  return scene;
}

}  // namespace

void measure_letters(PluginHost& host, Report& report) {
  Diagnostics ignored;
  Simulation with(scene_of_letters(host, true), host, ignored);
  Simulation without(scene_of_letters(host, false), host, ignored);
  Observer nobody;
  const auto steps = [&](Simulation& simulation) {
    return [&] { simulation.advance({{}, 20}, nobody); };
  };
  for (const double time : {0.1, 0.5, 1.}) {
    with.run_to(time, nobody);
    double seconds[2] = {1e9, 1e9};
    for (int round = 0; round < 6; ++round) {
      seconds[0] = std::min(seconds[0], measure(steps(without), 1, 0.2).median / 20);
      seconds[1] = std::min(seconds[1], measure(steps(with), 1, 0.2).median / 20);
    }
    report.add(Line()
                   .add("s", with.time())
                   .add("elements", static_cast<double>(with.complex().element_count()))
                   .add("touching", static_cast<double>(with.contact()->touches().size()))
                   .add("us without", 1e6 * seconds[0])
                   .add("us with", 1e6 * seconds[1])
                   .add("ratio", seconds[1] / seconds[0]));
  }
}

}  // namespace suture::bench
