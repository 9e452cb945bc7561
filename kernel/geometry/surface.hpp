// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "kernel/base/box.hpp"

namespace suture {

using Triangle = std::array<Index, 3>;

/// Triangles with shared points, m. If they bound a body, they are counterclockwise as seen from
/// outside; the positive side of a blade is the one from which they appear counterclockwise.
struct TriangleSurface {
  std::string source;  ///< file name, for messages
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
};

/// Faces as stored in files: polygon i has the corners corners[offsets[i]] ..
/// corners[offsets[i+1]-1].
struct PolygonSoup {
  std::string source;
  std::vector<Vec3> points;
  std::vector<Index> corners;
  std::vector<Index> offsets{0};

  std::size_t size() const { return offsets.size() - 1; }
};

Box box_of(const std::vector<Vec3>& points);

}  // namespace suture
