// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/geometry/surface.hpp"
#include "kernel/mesh/file_text.hpp"

namespace suture {

/// Points and polygons of VTK's XML file of PolyData; strips, lines and vertices are
/// passed over. Throws InputError with a line or byte.
PolygonSoup read_vtp(const FileText& file);

}  // namespace suture
