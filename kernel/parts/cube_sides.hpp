// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "kernel/mesh/parts.hpp"
#include "kernel/topology/dart.hpp"
#include "kernel/topology/hexahedron_tables.hpp"

namespace suture {

/// A side of the reference cube [-1, 1]^3.
struct CubeSide {
  unsigned axis;
  bool is_upper;

  int face() const {  // x0, y0, x1, y1, z0, z1
    constexpr int faces[3][2] = {{0, 2}, {1, 3}, {4, 5}};
    return faces[axis][is_upper ? 1 : 0];
  }
  double place() const { return is_upper ? 1 : -1; }
  CubeSide opposite() const { return {axis, !is_upper}; }
};
inline constexpr std::array<CubeSide, 6> cube_sides{
    {{0, false}, {0, true}, {1, false}, {1, true}, {2, false}, {2, true}}};

/// The sides on which a point lies: bit i for cube_sides[i].
inline std::uint8_t sides_at(const Vec3& at) {
  unsigned sides = 0;
  for (unsigned i = 0; i < cube_sides.size(); ++i)
    sides |= (at[cube_sides[i].axis] == cube_sides[i].place() ? 1u : 0u) << i;
  return static_cast<std::uint8_t>(sides);
}

/// The place in cube_sides of the side with a local face.
inline unsigned side_with_face(unsigned face) {
  unsigned s = 0;
  while (static_cast<unsigned>(cube_sides[s].face()) != face) ++s;
  return s;
}

/// That of the side on which a dart lies.
inline unsigned cube_side_of(Dart dart) { return side_with_face(local_face(dart)); }

inline Vec3 corner_place(std::size_t corner) {
  return {(corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0,
          (corner & 4) != 0 ? 1.0 : -1.0};
}

/// Counterclockwise as seen from outside, the lowest first.
inline std::array<unsigned, 4> corners_of(CubeSide side) {
  const unsigned u = 1u << (side.axis + 1) % 3, v = 1u << (side.axis + 2) % 3;
  const unsigned low = side.is_upper ? 1u << side.axis : 0;
  return side.is_upper ? std::array{low, low | u, low | u | v, low | v}
                       : std::array{low, low | v, low | u | v, low | u};
}

/// The ends of the edge of the cube on which a point lies: its corners, the same one for a corner.
struct EdgeEnds {
  unsigned low = 0, high = 0;

  explicit EdgeEnds(const Vec3& at) {
    for (unsigned a = 0; a < 3; ++a) {
      if (at[a] == 1) low |= 1u << a;
      if (at[a] != -1) high |= 1u << a;
    }
  }
  bool is_corner() const { return low == high; }
};

/// The faces of a positively oriented tetrahedron, seen from outside; face i is opposite corner i.
inline constexpr std::array<std::array<unsigned, 3>, 4> tetrahedron_faces{
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

}  // namespace suture
