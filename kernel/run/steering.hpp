// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/forces/contact_law.hpp"
#include "kernel/scene/scene.hpp"

namespace suture {

/// An obstacle, by place, and its path from now on.
struct Steering {
  std::size_t obstacle;
  RigidPath path;
};

/// The place of an obstacle among those of the contact (null without obstacles). Throws InputError
/// with the nearest name.
std::size_t obstacle_named(const std::string& name, const ContactLaw* contact);

/// The path to a target, from `now` on. Throws the errors of Simulation::steer(). `contact`: null
/// without obstacles.
Steering steering_to(const PoseTarget& target, const std::string& obstacle,
                     const ContactLaw* contact, double now, const SolverOptions& solver);

}  // namespace suture
