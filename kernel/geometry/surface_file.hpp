// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "kernel/base/diagnostics.hpp"
#include "kernel/geometry/surface.hpp"

namespace suture {

/// Faces of an .obj, .off, .ply, .stl (that by CGAL) or .vtp file, coordinates in m after
/// `scale`. Throws InputError: unknown extension (names the nearest), missing, empty,
/// damaged, no face, a coordinate that is not finite; with the line where the file has lines.
PolygonSoup read_soup(const std::filesystem::path& path, double scale = 1);

/// The same as triangles, for a blade. Throws InputError also for a face of other
/// than three corners.
TriangleSurface read_triangles(const std::filesystem::path& path, double scale = 1);

/// Writes .obj, .off, .ply (coordinates to the bit) or .stl (binary, single precision).
/// The file appears complete or not at all. Throws UsageError for another extension.
void write_surface(const std::filesystem::path& path, const TriangleSurface& surface);

/// Turns faces into triangles that bound a body: equal points are merged, faces
/// turned to one side, outward, polygons triangulated; faces there twice and
/// faces without area are dropped. Throws InputError for a surface with a border (says how
/// many edges) or that crosses itself (how many pairs of triangles). With `repair`,
/// each hole gets a lid and a surface may cross itself, with a warning each; what
/// several sheets enclose is inside. About 5 us per triangle.
TriangleSurface close_surface(const PolygonSoup& soup, bool repair, Diagnostics& diagnostics);

}  // namespace suture
