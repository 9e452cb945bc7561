// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Elements of which only a part is material. A surface that crosses the elements of a grid leaves
// in each the part that lies inside. The element keeps its eight nodes, some of which may lie
// outside the material; forces are integrated over the part, and what one sees is the surface
// inside it.

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/base/types.hpp"
#include "kernel/base/vec3.hpp"

namespace suture {

/// Moments of the material of an element in its reference cube [-1, 1]^3, means over the part.
struct PartMoments {
  double fraction = 1;  ///< volume of the part over that of the cube, in (0, 1]
  Vec3 centroid{};
  Vec3 covariance{};  ///< of (y, z), (x, z) and (x, y) about the centroid

  /// Whether the part is all of its element.
  bool is_whole() const { return fraction == 1; }
};

/// What the moments do not say if the element is no parallelepiped at rest.
struct GeneralPart {
  double fraction = 1;              ///< volume of the part over that of the element at rest
  std::array<Vec3, 4> gradients{};  ///< d_1 ... d_4 of SUTURE_GENERAL_PART_COLUMN
};

/// The position of an element in an ascending list, or its length if it is not there. O(log n).
inline std::size_t position_in(std::span<const Index> elements, Index element) {
  const auto found = std::ranges::lower_bound(elements, element);
  const bool is_there = found != elements.end() && *found == element;
  return is_there ? static_cast<std::size_t>(found - elements.begin()) : elements.size();
}

/// A point that moves with an element: at reference coordinates in [-1, 1]^3.
struct EmbeddedPoint {
  Index element = none;
  Vec3 at{};
};

/// The partial elements of a body, and its surface as it lies inside them.
struct Parts {
  std::vector<Index> elements;       ///< those of which only a part is material, ascending
  std::vector<PartMoments> moments;  ///< of each of them
  std::vector<GeneralPart> general;  ///< likewise; empty if all are parallelepipeds

  std::vector<EmbeddedPoint> points;  ///< corners of tetrahedra and triangles
  /// The material of partial elements: entry i of `elements` has the tetrahedra from first[i] to
  /// first[i + 1]; positively oriented corners are positions in `points`.
  std::vector<std::array<Index, 4>> tetrahedra;
  std::vector<Index> first;
  /// By tetrahedron: the number, within its element, of the convex cell that it is a piece of.
  /// Empty: each tetrahedron is a cell.
  std::vector<Index> cells;
  /// The surface of the body, closed and oriented outwards.
  std::vector<std::array<Index, 3>> triangles;
  std::vector<std::uint8_t> is_cut;  ///< by triangle: a blade made it; empty: none
  /// By element, bit f: its side f is part of the surface of the body from the start. Empty if the
  /// triangles are all of that surface.
  std::vector<std::uint8_t> outer_sides;

  bool empty() const { return elements.empty(); }
};

}  // namespace suture
