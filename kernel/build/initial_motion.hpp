// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "kernel/attributes/attributes.hpp"
#include "kernel/scene/initial_motion.hpp"

namespace suture {

/// Adds v = velocity + spin x (X - centre) to the velocities of `vertices`. O(vertices).
void add_initial_motion(const InitialMotion& motion, std::span<const Index> vertices,
                        Attributes& attributes);

}  // namespace suture
