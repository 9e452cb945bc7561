// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/dynamics/rest_sums.hpp"

#include <algorithm>

#include "kernel/dynamics/contact_forces.hpp"
#include "kernel/forces/loops/dispatch.hpp"

namespace suture {
loops::RestSums RestSums::evaluate(Motion& motion) {
  constexpr Index part = 4096;
  motion.evaluate();
  const WithContactForces with_contact(motion.body());
  Body& body = motion.body();
  Attributes& attributes = body.attributes();
  const std::size_t size = std::size_t{attributes.vertex_count()} * 4;
  loops::RestInput in{};
  in.position = attributes.position().rows();
  in.velocity = attributes.velocity().rows();
  in.force = attributes.force().rows();
  in.mass = attributes.mass().rows();
  in.fixed = attributes.fixed().rows();
  std::ranges::copy(body.acceleration(motion.time()), in.gravity);
  if (body.has_loads()) {
    external_.assign(size, 0);
    for (const auto& term : body.loads()) term->add_forces(motion.time(), {}, external_.data());
    in.external = external_.data();
  }
  if (old_position_.size() != size || jumps_ != motion.jumps()) {
    old_position_.assign(in.position, in.position + size);
    old_force_.assign(in.force, in.force + size);
    jumps_ = motion.jumps();
  }
  in.old_position = old_position_.data();
  in.old_force = old_force_.data();
  loops::RestSums sum{};
  for (Index begin = 0; begin < attributes.vertex_count(); begin += part) {
    const Index end = std::min(begin + part, attributes.vertex_count());
    const loops::RestSums here = hot_loops().rest_sums(&in, begin, end);
    sum.residual += here.residual;
    sum.external += here.external;
    sum.reaction += here.reaction;
    sum.kinetic += here.kinetic;
    sum.work += here.work;
    sum.inertia += here.inertia;
  }
  return sum;
}

void RestSums::state(Archive& archive) {
  archive("old position", old_position_);
  archive("old force", old_force_);
  archive("jumps", jumps_);
}

}  // namespace suture
