// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/near_edges.hpp"

#include <algorithm>

#include "kernel/base/rows.hpp"
#include "kernel/base/sort_unique.hpp"
#include "kernel/contact/place_grid.hpp"
#include "kernel/topology/seam.hpp"

namespace suture {
namespace {

constexpr double flat = 0.951;     // cosine of 18 degrees
constexpr double parallel = 0.01;  // squared sine of an angle

Vec3 area_of(const BoundarySurface::Corners& c, const double* positions) {
  return cross(minus(row(positions, c[2]), row(positions, c[0])),
               minus(row(positions, c[3]), row(positions, c[1])));
}

/// The edge is one that runs counterclockwise around the first face.
bool bends_outward(const Vec3& first, const Vec3& second, const Vec3& edge) {
  return dot(first, second) < flat * norm(first) * norm(second) &&
         dot(cross(first, second), edge) > 0;
}

bool share_an_end(const FeatureEdge& a, const FeatureEdge& b) {
  return std::ranges::any_of(a.ends, [&](Index v) { return v == b.ends[0] || v == b.ends[1]; });
}

Box box_around(const FeatureEdge& edge, const double* positions, double reach) {
  Box box = no_box;
  for (const Index v : edge.ends) include(box, row(positions, v));
  return enlarged(box, reach);
}

Vec3 middle_of(const FeatureEdge& edge, const double* positions) {
  return scaled(0.5, plus(row(positions, edge.ends[0]), row(positions, edge.ends[1])));
}

/// The largest distance along an axis from the middle of an edge to its ends.
double half_length(std::span<const FeatureEdge> edges, const double* positions) {
  double longest = 0;
  for (const FeatureEdge& edge : edges) {
    const Vec3 along = minus(row(positions, edge.ends[1]), row(positions, edge.ends[0]));
    for (const double c : along) longest = std::max(longest, std::abs(c) / 2);
  }
  return longest;
}

}  // namespace

/// The corners i and i + 1 of a face are the ends of its dart 3 - i.
std::vector<FeatureEdge> feature_edges(const CellComplex& complex, const BoundarySurface& surface,
                                       const double* rest) {
  std::vector<FeatureEdge> edges;
  for (Index place = 0; place < surface.faces().size(); ++place) {
    const BoundarySurface::Corners& corners = surface.corners()[place];
    const Vec3 area = area_of(corners, rest);
    for (Index i = 0; i < 4; ++i) {
      const Dart dart = 4 * surface.faces()[place] + 3 - i;
      const Dart other = across_edge(complex, dart);
      if (other < dart) continue;
      const Index face = surface.place(other / 4);
      const std::array<Index, 2> ends{corners[i], corners[(i + 1) % 4]};
      const Vec3 along = minus(row(rest, ends[1]), row(rest, ends[0]));
      if (bends_outward(area, area_of(surface.corners()[face], rest), along))
        edges.push_back({ends, {place, face}});
    }
  }
  std::ranges::sort(edges, {}, &FeatureEdge::ends);
  return edges;
}

std::vector<NearEdges> near_edges(std::span<const FeatureEdge> edges,
                                  std::span<const Index> piece_of, bool self,
                                  const double* positions, double reach) {
  const double half = half_length(edges, positions);
  std::vector<PlaceGrid::Entry> middles;
  for (Index i = 0; i < edges.size(); ++i)
    middles.push_back({middle_of(edges[i], positions), i, piece_of[edges[i].ends[0]]});
  PlaceGrid grid(middles, 2 * (half + reach), 2 * (half + reach));
  std::vector<NearEdges> pairs;
  for (Index i = 0; i < edges.size(); ++i) {
    const Box box = box_around(edges[i], positions, reach);
    const Index piece = piece_of[edges[i].ends[0]];
    for (const Index j : grid.find(enlarged(box, half), self ? none : piece)) {
      if (j <= i || (piece_of[edges[j].ends[0]] == piece && share_an_end(edges[i], edges[j])))
        continue;
      if (overlap(box, box_around(edges[j], positions, 0))) pairs.push_back({i, j});
    }
  }
  sort_unique(pairs);
  return pairs;
}

/// The minimum of |offset + s a - t b| over all s and t.
bool find_crossing(const std::array<Vec3, 2>& first, const std::array<Vec3, 2>& second,
                   Crossing& crossing) {
  const Vec3 a = minus(first[1], first[0]), b = minus(second[1], second[0]);
  const Vec3 normal = cross(a, b), offset = minus(first[0], second[0]);
  const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b), det = dot(normal, normal);
  if (!(det > parallel * aa * bb)) return false;
  crossing.first = (ab * dot(b, offset) - bb * dot(a, offset)) / det;
  crossing.second = (aa * dot(b, offset) - ab * dot(a, offset)) / det;
  crossing.across = scaled(1 / std::sqrt(det), normal);
  crossing.offset = scaled(dot(crossing.across, offset), crossing.across);
  return true;
}

}  // namespace suture
