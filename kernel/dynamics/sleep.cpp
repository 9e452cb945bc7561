// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/sleep.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "kernel/base/error.hpp"

namespace suture {
namespace {

std::vector<Index> vertices_of(const CellComplex& complex, std::span<const Index> elements) {
  std::vector<Index> vertices;
  for (const Index e : elements) {
    const Hexahedron& nodes = complex.vertices_of(e);
    vertices.insert(vertices.end(), nodes.begin(), nodes.end());
  }
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
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
    for (int f = 0; f < 6; ++f) {
      const Index other = complex.neighbour(e, f);
      if (other != none && !inside[other])
        throw InputError("element " + std::to_string(body.user_element(e)) +
                         " cannot sleep on its own: it is connected to element " +
                         std::to_string(body.user_element(other)) + "; put whole islands to sleep");
    }
}

/// In the free components.
Vec3 total_force(Attributes& attributes, const Vec3& gravity, Index vertex) {
  const int bits = static_cast<int>(attributes.fixed().get(vertex, 0));
  Vec3 f{};
  for (int c = 0; c < 3; ++c)
    if ((bits >> c & 1) == 0)
      f[static_cast<std::size_t>(c)] =
          attributes.force().get(vertex, c) +
          attributes.mass().get(vertex, 0) * gravity[static_cast<std::size_t>(c)];
  return f;
}

}  // namespace

Stillness stillness(Dynamics& dynamics, std::span<const Index> elements) {
  dynamics.synchronise();
  Attributes& attributes = dynamics.body().attributes();
  const Vec3 gravity = dynamics.body().acceleration(dynamics.time());
  Stillness result;
  double squares = 0;
  for (const Index v : vertices_of(dynamics.body().complex(), elements)) {
    const Vec3 f = total_force(attributes, gravity, v);
    const double force = std::hypot(f[0], f[1], f[2]);
    squares += force * force;
    const Column& velocity = attributes.velocity();
    const double speed = std::hypot(velocity.get(v, 0), velocity.get(v, 1), velocity.get(v, 2));
    result.acceleration = std::max(result.acceleration, force / attributes.mass().get(v, 0));
    result.velocity = std::max(result.velocity, speed);
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
      },
      true);
}

void wake_all(Dynamics& dynamics) { dynamics.motion().thaw(); }
bool sleeps(const Dynamics& dynamics) { return dynamics.motion().is_frozen(); }

}  // namespace suture
