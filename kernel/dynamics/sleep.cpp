// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/sleep.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "kernel/base/error.hpp"
#include "kernel/base/rows.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/dynamics/forces_of_step.hpp"
#include "kernel/dynamics/residual.hpp"
#include "kernel/forces/contact_law.hpp"

namespace suture {
namespace {

std::vector<Index> vertices_of(const CellComplex& complex, std::span<const Index> elements) {
  std::vector<Index> vertices;
  for (const Index e : elements) {
    const Hexahedron& nodes = complex.vertices_of(e);
    vertices.insert(vertices.end(), nodes.begin(), nodes.end());
  }
  sort_unique(vertices);
  return vertices;
}

void require_islands(const Body& body, std::span<const Index> elements) {
  const CellComplex& complex = body.complex();
  std::vector<bool> inside(complex.element_count());
  for (const Index e : elements) {
    if (e >= complex.element_count() || !complex.exists(3, e))
      throw InputError("element " + std::to_string(e) + " cannot sleep: it does not exist");
    inside[e] = true;
  }
  for (const Index e : elements)
    for (int f = 0; f < hexahedron::faces; ++f) {
      const Index other = complex.neighbour(e, f);
      if (other != none && !inside[other])
        throw InputError("element " + std::to_string(body.user_element(e)) +
                         " cannot sleep on its own: it is connected to element " +
                         std::to_string(body.user_element(other)) + "; put whole islands to sleep");
    }
}

}  // namespace

Stillness stillness(Dynamics& dynamics, std::span<const Index> elements) {
  dynamics.motion().evaluate();
  const ForcesOfStep of_step(dynamics.motion());
  const Kick lacking = dynamics.lacking();
  Attributes& attributes = dynamics.body().attributes();
  const Residual unbalanced(dynamics.motion());
  Stillness result;
  double squares = 0;
  for (const Index v : vertices_of(dynamics.body().complex(), elements)) {
    const Vec3 f = unbalanced.free_force(v);
    const double force = norm(f), mass = attributes.mass().get(v, 0);
    const Vec3 velocity = plus(scaled(lacking.decay, row(attributes.velocity().rows(), v)),
                               scaled(lacking.gain / mass, f));
    squares += force * force;
    result.acceleration = std::max(result.acceleration, force / mass);
    result.velocity = std::max(result.velocity, norm(velocity));
  }
  result.residual = std::sqrt(squares);
  return result;
}

void put_to_sleep(Dynamics& dynamics, std::span<const Index> elements) {
  if (elements.empty()) return;
  Body& body = dynamics.body();
  require_islands(body, elements);
  dynamics.synchronise();  // what sleeps keeps the forces of this state
  dynamics.jump(
      [&] {
        body.models().sleep(elements);
        dynamics.motion().freeze(vertices_of(body.complex(), elements));
        if (body.contact()) body.contact()->change_sleepers(dynamics.motion().moving());
      },
      true);
}

void wake_all(Dynamics& dynamics) { wake_except(dynamics, {}); }

void wake_except(Dynamics& dynamics, std::span<const Index> asleep) {
  Body& body = dynamics.body();
  dynamics.synchronise();
  dynamics.jump(
      [&] {
        body.models().wake_all();
        if (!asleep.empty()) body.models().sleep(asleep);
        dynamics.motion().thaw_except(vertices_of(body.complex(), asleep));
        if (body.contact()) body.contact()->change_sleepers(dynamics.motion().moving());
      },
      true);
}

bool sleeps(const Dynamics& dynamics) { return dynamics.motion().is_frozen(); }

}  // namespace suture
