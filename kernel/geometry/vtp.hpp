// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/geometry/surface.hpp"
#include "kernel/mesh/file_text.hpp"

namespace suture {

/// Reads the points and polygons of VTK's XML format for PolyData; strips, lines and vertices are
/// skipped. Throws InputError with a line or byte.
PolygonSoup read_vtp(const FileText& file);

}  // namespace suture
