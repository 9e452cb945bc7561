// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/scene/scene.hpp"

namespace suture {

/// The position of a body in its scene. Inside the kernel, positions are relative to the body's own
/// origin, so that their rounding does not depend on where the scene places the body.
struct BodyFrame {
  Vec3 origin{};        ///< in the scene, m
  double diagonal = 0;  ///< of the body at rest, m

  bool is_scene() const { return origin == Vec3{}; }
  /// The rounding of scene coordinates near the body, m; 0 if is_scene().
  double rounding() const;
  /// A point of the body in coordinates of the scene.
  Vec3 in_scene(const Vec3& local) const;
};

// Converts every coordinate to the body's origin. This is the only place that knows which members
// are coordinates: a new coordinate must be added here. Bounds of selections, discs and paths are
// extended by rounding(), so that points on them in the scene remain on them, and a plane is moved
// back by it, so that a centroid on it counts as positive. Changes no bit if frame.is_scene().
Scene in_frame(Scene scene, const BodyFrame& frame);
Event in_frame(Event event, const BodyFrame& frame);
Selection in_frame(Selection selection, const BodyFrame& frame);

}  // namespace suture
