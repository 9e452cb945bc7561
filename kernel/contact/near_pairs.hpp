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

/// What may touch what: different pieces; and within a piece, the vertices with the faces of which
/// both may touch their own piece, except those of which the vertex is a corner.
struct Meeting {
  std::vector<Index> piece_of;              ///< by vertex
  std::vector<char> vertex_meets_own = {};  ///< by vertex
  std::vector<char> face_meets_own = {};    ///< by place in BoundarySurface::corners()
};

/// The pairs that may touch where the vertex lies in the box around the face, enlarged by `reach`
/// on all sides, sorted. By a hash grid of the vertices: O(vertices + faces + pairs) for faces of
/// similar size, and never more than O(vertices) for a face.
std::vector<NearPair> near_pairs(const BoundarySurface& surface, const Meeting& meeting,
                                 const double* positions, double reach);
/// Pairs in the order of faces, sorted by vertex and face, each of them once; O(vertices + pairs).
/// The numbers of vertices are below `vertices`.
std::vector<NearPair> sorted_once(std::span<const NearPair> pairs, std::size_t vertices);

}  // namespace suture
