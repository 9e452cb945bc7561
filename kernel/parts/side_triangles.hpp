// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kernel/parts/cube_sides.hpp"
#include "kernel/parts/division.hpp"

namespace suture {

/// A triangle on a side of an element, in the plane of that side.
struct SideTriangle {
  std::array<std::array<double, 2>, 3> x;
  std::array<double, 2> centroid;

  double area() const;  ///< twice
  /// The corners in the cube.
  std::array<Vec3, 3> places(CubeSide side) const;
  bool contains(const std::array<double, 2>& p) const;
};

/// The triangles of a material on the sides of its element.
class SideTriangles {
 public:
  explicit SideTriangles(const Material& material);
  static const SideTriangles& of_full_element();

  /// Those on a side, by its place in cube_sides.
  std::span<const SideTriangle> operator[](unsigned side) const {
    const std::size_t first = side == 0 ? 0 : end_[side - 1];
    return std::span(triangles_).subspan(first, end_[side] - first);
  }

 private:
  std::vector<SideTriangle> triangles_;
  std::array<std::size_t, 6> end_{};
};

/// Whether the centroid lies in one of the others, which are on the same side of the cube.
bool is_covered(const SideTriangle& triangle, std::span<const SideTriangle> others);
/// Which of some triangles are covered.
struct Covered {
  double area = 0;  ///< of those, twice
  bool is_all = true;
};
Covered covered(std::span<const SideTriangle> some, std::span<const SideTriangle> others);

}  // namespace suture
