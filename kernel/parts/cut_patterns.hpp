// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kernel/base/types.hpp"

// A surface crosses a cube between the corners that lie inside and those that lie outside. The cube
// is divided into the six Kuhn tetrahedra around its diagonal X0-X7, in the same way in all cubes,
// so that faces of neighbours match. Of each tetrahedron, the part with its inner corners is
// material; it is divided into tetrahedra again. All this depends on the corners alone: it is one
// table of 256 patterns, and only the places of the crossings differ.

namespace suture {

/// A set of corners of a cube: bit i stands for X_i.
using CornerSet = std::uint8_t;
inline constexpr CornerSet all_corners = 0xFF;

/// A corner, or the crossing of an edge of the tetrahedra: 8 i + d for the edge from X_i to the
/// corner X_(i|d), d having no bit of i; the corner itself for d = 0. In a lattice of cubes whose
/// corners are numbered along x, y, z, these numbers have the same order in all cubes around a
/// point, which makes the diagonals of quadrilaterals agree.
using PatternPoint = std::uint8_t;
constexpr unsigned low_corner(PatternPoint point) { return point >> 3; }
constexpr unsigned direction(PatternPoint point) { return point & 7; }
constexpr unsigned high_corner(PatternPoint point) { return low_corner(point) | direction(point); }

/// The material of a cube of which these corners lie inside.
struct CutPattern {
  std::vector<PatternPoint> points;  ///< those used, ascending
  /// Corners are positions in `points`; oriented positively.
  std::vector<std::array<std::uint8_t, 4>> tetrahedra;
  std::vector<std::array<std::uint8_t, 3>> triangles;  ///< of the surface, oriented outwards
};

/// The table is made at the first call.
const CutPattern& cut_pattern(CornerSet inside);

/// The corners of each connected part of the material, ascending by their lowest corner. Corners
/// are connected by edges of the tetrahedra; each part has the pattern of its own corners.
std::vector<CornerSet> connected_parts(CornerSet inside);

/// Reference coordinates in [-1, 1]^3 of a point at `share` of its edge, from the low corner.
Vec3 place_of(PatternPoint point, double share);

}  // namespace suture
