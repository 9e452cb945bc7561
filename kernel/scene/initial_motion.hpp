// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "kernel/scene/selection.hpp"

namespace suture {

/// Velocities at the start of a run, v = velocity + spin x (X - centre), of vertices that no
/// constraint holds. Where entries share vertices, their velocities add up.
struct InitialMotion {
  Vec3 velocity{};               ///< m/s
  Vec3 spin{};                   ///< rad/s
  std::optional<Vec3> centre{};  ///< m; none: the centre of mass of the vertices
  Selection where;
};

}  // namespace suture
