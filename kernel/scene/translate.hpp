// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/scene/scene.hpp"

namespace suture {

/// Where a body lies in its scene. Inside the kernel, positions count from the body's own
/// origin, so that what they round to does not depend on where the scene puts it.
struct BodyFrame {
  Vec3 origin{};        ///< in the scene, m
  double diagonal = 0;  ///< of the body at rest, m

  bool is_scene() const { return origin == Vec3{}; }
  /// What coordinates of the scene near the body are known to, m; 0 if is_scene().
  double rounding() const;
  /// A point of the body, where the scene has it.
  Vec3 in_scene(const Vec3& local) const;
};

// What a scene says, with every coordinate from the body's origin. This is the one place
// that knows which members are coordinates: whoever adds one, adds it here. Bounds of
// selections, disks and paths reach further by rounding(), so that what lies on them in the
// scene still does, and a plane is moved back by it: a centroid on it counts as positive.
// To the bit the same if frame.is_scene().
Scene in_frame(Scene scene, const BodyFrame& frame);
Event in_frame(Event event, const BodyFrame& frame);
Selection in_frame(Selection selection, const BodyFrame& frame);

}  // namespace suture
