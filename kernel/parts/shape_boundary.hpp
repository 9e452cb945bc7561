// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "kernel/geometry/surface.hpp"
#include "kernel/mesh/mesh.hpp"

namespace suture {

/// A face on the boundary of solid cells: three or four points.
struct ShapeFace {
  std::array<Index, 4> corners{};
  std::size_t size = 0;
};

/// The faces that belong to one cell only. Points at the same place count as one: files often
/// repeat them where two materials meet. 0.5 us per face of the cells.
std::vector<ShapeFace> boundary_of(const Mesh& shape);

/// The same for close_surface().
PolygonSoup soup_of(const Mesh& shape, const std::vector<ShapeFace>& faces);

}  // namespace suture
