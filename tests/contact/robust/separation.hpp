// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/attributes/attributes.hpp"
#include "kernel/geometry/obstacle.hpp"

namespace suture::test {

/// A point of a surface on the wrong side of another one.
struct Intrusion {
  double depth = 0;  ///< m
  Vec3 place{};
  bool is_on_edge = false;  ///< the middle of an edge; else a node
  const char* into = "";    ///< "a piece", "its own piece", "an obstacle"
};

/// The deepest intrusion of nodes and of middles of edges of the boundary, by a search of all faces
/// that uses no code of contact: the winding number says what is inside. `edge`: of elements, m.
/// Obstacles: half-spaces, spheres.
Intrusion deepest_intrusion(const CellComplex& complex, Attributes& attributes,
                            const std::vector<Obstacle>& obstacles, double time, double edge);

}  // namespace suture::test
