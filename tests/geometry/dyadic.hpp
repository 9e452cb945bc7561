// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <random>
#include <vector>

#include "kernel/geometry/centroids.hpp"

namespace suture::test {

// Coordinates that are multiples of 2^-10: sums, means of eight and differences are
// exact in doubles, and determinants in 128-bit integers.

/// A grid of unit cubes: its map and its places.
struct Block {
  CellComplex complex;
  std::vector<double> rows;  ///< stride 4

  Places places() const { return {rows.data(), 4}; }
};
Block block_of(Index nx, Index ny, Index nz);
/// Every coordinate moved by a multiple of 1/1024, at most `amplitude`.
Block jittered_block(Index nx, Index ny, Index nz, double amplitude, std::mt19937& random);

/// Triangles between points of the lattice of `unit` in [-1, 6]^3.
TriangleSurface random_surface(Index points, Index triangles, double unit, std::mt19937& random);

/// The rule of SurfaceBlade in integers, no tree, no grid.
bool crosses_exactly(const std::array<Vec3, 3>& triangle, const Vec3& a, const Vec3& b);
std::vector<Dart> every_face_against_every_triangle(const TriangleSurface& surface,
                                                    const Block& block);

}  // namespace suture::test
