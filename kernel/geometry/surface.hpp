// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "kernel/base/box.hpp"

namespace suture {

using Triangle = std::array<Index, 3>;

/// Triangles over shared points, m. Where they bound a body they are seen from
/// outside counterclockwise; a blade's positive side is the one from which they are.
struct TriangleSurface {
  std::string source;  ///< file name, for messages
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
};

/// Faces as files hold them: polygon i has the corners
/// corners[offsets[i]] .. corners[offsets[i+1]-1].
struct PolygonSoup {
  std::string source;
  std::vector<Vec3> points;
  std::vector<Index> corners;
  std::vector<Index> offsets{0};

  std::size_t size() const { return offsets.size() - 1; }
};

Box box_of(const std::vector<Vec3>& points);

}  // namespace suture
