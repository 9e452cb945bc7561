// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/dynamics_impl.hpp"

namespace suture {

std::vector<Index> Dynamics::Impl::vertices_of(std::span<const Index> elements) const {
  std::vector<Index> vertices;
  for (const Index e : elements) {
    const Hexahedron& nodes = complex->vertices_of(e);
    vertices.insert(vertices.end(), nodes.begin(), nodes.end());
  }
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

void Dynamics::Impl::require_islands(std::span<const Index> elements) const {
  std::vector<bool> inside(complex->element_count());
  for (const Index e : elements) {
    if (e >= complex->element_count() || !complex->exists(3, e))
      throw InputError("element " + std::to_string(e) + " cannot sleep: there is none");
    inside[e] = true;
  }
  for (const Index e : elements)
    for (int f = 0; f < 6; ++f) {
      const Index other = complex->neighbour(e, f);
      if (other != none && !inside[other])
        throw InputError("element " + std::to_string(shown(e)) +
                         " cannot sleep alone: it hangs together with element " +
                         std::to_string(shown(other)) + "; put whole islands to sleep");
    }
}

/// Of the models, the loads and gravity, in the free components.
Vec3 Dynamics::Impl::total_force(Index vertex) const {
  const int bits = static_cast<int>(attributes.fixed().get(vertex, 0));
  const double weight = options.gravity_ramp.value(time) * attributes.mass().get(vertex, 0);
  Vec3 f{};
  for (int c = 0; c < 3; ++c)
    if ((bits >> c & 1) == 0)
      f[static_cast<std::size_t>(c)] =
          attributes.force().get(vertex, c) + weight * options.gravity[static_cast<std::size_t>(c)];
  return f;
}

Dynamics::Stillness Dynamics::stillness(std::span<const Index> elements) {
  synchronise();
  Stillness result;
  double squares = 0;
  for (const Index v : impl_->vertices_of(elements)) {
    const Vec3 f = impl_->total_force(v);
    const double force = std::hypot(f[0], f[1], f[2]);
    squares += force * force;
    const Column& velocity = impl_->attributes.velocity();
    const double speed = std::hypot(velocity.get(v, 0), velocity.get(v, 1), velocity.get(v, 2));
    result.acceleration = std::max(result.acceleration, force / impl_->attributes.mass().get(v, 0));
    result.velocity = std::max(result.velocity, speed);
  }
  result.residual = std::sqrt(squares);
  return result;
}

void Dynamics::sleep(std::span<const Index> elements) {
  if (elements.empty()) return;
  impl_->require_islands(elements);
  synchronise();  // what sleeps keeps the forces of this state
  if (!impl_->asleep) impl_->awake = impl_->attributes.kernel(0).cells.live();
  impl_->ledger.before_jump(impl_->now());
  impl_->asleep = true;
  impl_->forces.sleep(elements);
  for (const Index v : impl_->vertices_of(elements)) {
    impl_->awake.kill(v, impl_->attributes.vertex_count());
    for (int c = 0; c < 3; ++c) impl_->attributes.velocity().set(v, c, 0);
  }
  impl_->ledger.forget_last();
  impl_->ledger.after_jump(impl_->now());
}

void Dynamics::wake_all() { impl_->wake(); }
bool Dynamics::sleeps() const { return impl_->asleep; }

}  // namespace suture
