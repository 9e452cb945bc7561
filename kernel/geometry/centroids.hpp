// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/base/parallel.hpp"
#include "kernel/geometry/surface.hpp"
#include "kernel/topology/cell_complex.hpp"

// A blade cuts a face when it crosses its link: the segment between the centroids of
// the face's two elements.

namespace suture {

/// Positions of vertices: vertex v is at rows[stride * v], 3 doubles, m, deformed or at rest.
struct Places {
  const double* rows;
  std::size_t stride = 4;

  Vec3 at(Index v) const {
    const double* x = rows + stride * v;
    return {x[0], x[1], x[2]};
  }
};

/// Three coordinates, padded to 32 bytes.
using Row4 = std::array<double, 4>;

inline Vec3 xyz(const Row4& row) { return {row[0], row[1], row[2]}; }

/// The mean of an element's corners, summed in the order X0..X7.
inline Row4 centroid_of(const Hexahedron& corners, const Places& places) {
  Row4 sum{};
  for (const Index v : corners) {
    const double* x = places.rows + places.stride * v;
    for (std::size_t a = 0; a < 3; ++a) sum[a] += x[a];
  }
  for (double& x : sum) x *= 0.125;
  return sum;
}

/// How many vertices or elements a thread takes at once.
inline constexpr std::size_t chunk_size = 16384;

/// The message for a blade that has cut nothing: it lies outside the body, or it meets the body's
/// bounding box but separates no two elements (or, if it divides elements, holds no whole section
/// of one). Both boxes are given in the coordinates of the scene, shifted by `origin` (m).
std::string why_nothing_was_cut(const Box& blade, const CellComplex& complex, const Places& places,
                                const Vec3& origin = {}, bool divides = false);

}  // namespace suture
