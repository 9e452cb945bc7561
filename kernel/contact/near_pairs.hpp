// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/contact/boundary_surface.hpp"

namespace suture {

/// A vertex and a boundary face that are near each other.
struct NearPair {
  Index vertex;
  Index face;  ///< by place in BoundarySurface::corners()
  auto operator<=>(const NearPair&) const = default;
};

/// The pairs of a vertex and a face of different pieces where the vertex lies in the box around the
/// face, enlarged by `reach` on all sides, sorted. `piece_of`: by vertex. By a hash grid of the
/// vertices: O(vertices + faces + pairs) for faces of similar size.
std::vector<NearPair> near_pairs(const BoundarySurface& surface, std::span<const Index> piece_of,
                                 const double* positions, double reach);

}  // namespace suture
