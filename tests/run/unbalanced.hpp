// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "kernel/base/aligned.hpp"
#include "kernel/build/built_scene.hpp"
#include "kernel/run/simulation.hpp"
#include "kernel/scene/scene_reader.hpp"

namespace suture::test {

/// The norm of the forces on free components, gravity included, relative to the largest of the
/// norms of external forces and of reactions: what an equilibrium has below its tolerance.
inline double unbalanced(Simulation& simulation) {
  Dynamics& dynamics = simulation.built().dynamics();
  Body& body = dynamics.body();
  Attributes& attributes = body.attributes();
  dynamics.synchronise();
  const Vec3 gravity = body.acceleration(dynamics.time());
  AlignedVector<double> given(std::size_t{attributes.vertex_count()} * 4);
  for (const auto& term : body.loads())
    term->add_forces(dynamics.time(), attributes.kernel(0).cells.live(), given.data());
  double free = 0, reaction = 0, external = 0;
  for (Index v = 0; v < attributes.vertex_count(); ++v) {
    if (!body.complex().exists(0, v)) continue;
    for (int c = 0; c < 3; ++c) {
      const auto component = static_cast<std::size_t>(c);
      const double weight = attributes.mass().get(v, 0) * gravity[component];
      const double force = attributes.force().get(v, c) + weight;
      const bool is_held = static_cast<int>(attributes.fixed().get(v, 0)) >> c & 1;
      (is_held ? reaction : free) += force * force;
      const double load = given[4 * std::size_t{v} + component] + weight;
      external += is_held ? 0 : load * load;
    }
  }
  return std::sqrt(free / std::max(reaction, external));
}

/// A scene as the program would read it, with models of `host`.
inline Scene scene_of(const std::string& text, PluginHost& host) {
  Diagnostics ignored;
  const ModelLookup lookup{
      [&](std::string_view id) -> const suture_model& { return host.model(id); },
      [](const std::filesystem::path&) {}};
  return read_scene_text(text, "scene.json", {}, lookup, ignored);
}

}  // namespace suture::test
