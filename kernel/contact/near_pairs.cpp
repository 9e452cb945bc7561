// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/near_pairs.hpp"

#include <algorithm>

#include "kernel/base/rows.hpp"
#include "kernel/contact/place_grid.hpp"

namespace suture {
namespace {

// Where pieces are packed; memory for more is found when it is needed.
constexpr std::size_t pairs_per_face = 8;

Box box_around(const BoundarySurface::Corners& corners, const double* positions, double reach) {
  Box box = no_box;
  for (const Index corner : corners) include(box, row(positions, corner));
  return enlarged(box, reach);
}

PlaceGrid grid_of(const BoundarySurface& surface, const Meeting& meeting, const double* positions,
                  double reach) {
  std::vector<PlaceGrid::Entry> entries;
  entries.reserve(surface.vertices().size());
  for (const Index v : surface.vertices())
    entries.push_back({row(positions, v), v, meeting.piece_of[v]});
  return {entries, 3 * reach, 2 * reach};
}

}  // namespace

std::vector<NearPair> near_pairs(const BoundarySurface& surface, const Meeting& meeting,
                                 const double* positions, double reach) {
  PlaceGrid grid = grid_of(surface, meeting, positions, reach);
  std::vector<NearPair> pairs;
  pairs.reserve(pairs_per_face * surface.corners().size());
  for (Index face = 0; face < surface.corners().size(); ++face) {
    const BoundarySurface::Corners& corners = surface.corners()[face];
    const Index piece = meeting.piece_of[corners[0]];
    const bool meets_own = !meeting.face_meets_own.empty() && meeting.face_meets_own[face];
    const Box box = box_around(corners, positions, reach);
    for (const Index vertex : grid.find(box, meets_own ? none : piece)) {
      if (meets_own && meeting.piece_of[vertex] == piece &&
          (!meeting.vertex_meets_own[vertex] ||
           std::ranges::find(corners, vertex) != corners.end()))
        continue;
      pairs.push_back({vertex, face});
    }
  }
  return sorted_once(pairs, meeting.piece_of.size());
}

std::vector<NearPair> sorted_once(std::span<const NearPair> pairs, std::size_t vertices) {
  std::vector<Index> next(vertices + 1, 0);
  for (const NearPair& pair : pairs) ++next[pair.vertex + 1];
  for (std::size_t v = 0; v < vertices; ++v) next[v + 1] += next[v];
  std::vector<NearPair> sorted(pairs.size());
  for (const NearPair& pair : pairs) sorted[next[pair.vertex]++] = pair;
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  return sorted;
}

}  // namespace suture
