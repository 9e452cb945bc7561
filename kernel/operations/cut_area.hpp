// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <string>

#include "kernel/base/types.hpp"

namespace suture {

/// An end of a blade counts as reached if it lies this part of the shortest edge at it before the
/// end of an element: round numbers end on planes of the grid, and rounding must not decide.
inline constexpr double reach_in_edges = 0.02;

/// What a cut has opened of the part of its blade that is in the body, m^2. Both are 0 if it was
/// not measured: the blade ends nowhere, or is still moving.
struct CutArea {
  double opened = 0, blade = 0;
  /// "0.012 of the 0.013 m^2 of the blade in the body"
  std::string text() const;
  void operator+=(const CutArea& other) {
    opened += other.opened;
    blade += other.blade;
  }
};

using Corners3 = std::array<Vec3, 3>;
double area_of(const Corners3& triangle);
/// The area of the part of a triangle that `holds`, found in 16 equal parts of it, each by its
/// middle.
double held_area(const Corners3& triangle, const std::function<bool(const Vec3&)>& holds);
/// Where a tetrahedron has the height 0, as up to two triangles. Corners of at most `tolerance` lie
/// at 0; a face at 0 belongs to the tetrahedron below it.
struct Section {
  std::array<Corners3, 2> triangles;
  std::size_t count = 0;
};
Section section_of(const std::array<Vec3, 4>& corners, const std::array<double, 4>& heights,
                   double tolerance);

}  // namespace suture
