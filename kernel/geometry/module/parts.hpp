// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/geometry/geometry_module.hpp"

// Inside libsuture-geometry.so only: its two halves, each one translation unit.

namespace suture::cgal {

// surfaces.cpp
std::string write(SurfaceFormat format, const TriangleSurface& surface);
Closing close(const PolygonSoup& soup, bool repair);

// queries.cpp
std::vector<std::uint8_t> fill(const TriangleSurface& surface, const CubeGrid& grid);
std::unique_ptr<TriangleTree> tree(const TriangleSurface& surface);
bool crosses(const std::array<Vec3, 3>& triangle, const Segment& link);

}  // namespace suture::cgal
