// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/contact/near_pairs.hpp"

namespace suture {

/// An edge of the boundary where the surface bends outward by more than 18 degrees at rest.
struct FeatureEdge {
  std::array<Index, 2> ends;   ///< counterclockwise around the first face
  std::array<Index, 2> faces;  ///< by place in BoundarySurface::corners()
};

/// All of them, in the order of their ends. `rest`: positions, rows of 4. O(faces).
std::vector<FeatureEdge> feature_edges(const CellComplex& complex, const BoundarySurface& surface,
                                       const double* rest);

/// Two edges that are near each other, by their place in a list; first < second.
struct NearEdges {
  Index first, second;
  auto operator<=>(const NearEdges&) const = default;
};

/// The pairs of edges whose boxes, one of them enlarged by `reach` on all sides, overlap, and that
/// `may_meet`, sorted: those of different pieces, and with `self` also those of a piece that share
/// no end. O(edges + pairs) for edges of similar length.
std::vector<NearEdges> near_edges(std::span<const FeatureEdge> edges,
                                  std::span<const Index> piece_of, bool self,
                                  const double* positions, double reach);

/// Where the lines of two edges are nearest to each other.
struct Crossing {
  double first, second;  ///< along the edges: 0 at the first end, 1 at the second
  Vec3 offset;           ///< from the second to the first, between the nearest points of the lines
  Vec3 across;           ///< at right angles to both, of length 1
};
/// False if they are parallel to within a tenth of a radian.
bool find_crossing(const std::array<Vec3, 2>& first, const std::array<Vec3, 2>& second,
                   Crossing& crossing);

}  // namespace suture
