// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "kernel/base/diagnostics.hpp"
#include "kernel/geometry/geometry_module.hpp"
#include "kernel/geometry/surface.hpp"

namespace suture {

class SolidSurface;

/// Reads the faces of an .obj, .off, .ply, .stl or .vtp file; coordinates are in m
/// after `scale`. Throws InputError for an unknown extension (names the nearest), a file that is
/// missing, empty, damaged or without faces, and a coordinate that is not finite; names the line in
/// text files.
PolygonSoup read_soup(const std::filesystem::path& path, double scale = 1);

/// The same as triangles, for a blade. Also throws InputError for a face that does not have three
/// corners.
TriangleSurface read_triangles(const std::filesystem::path& path, double scale = 1);

/// Writes .obj, .off, .ply (exact coordinates) or .stl (binary, single precision). The file appears
/// complete or not at all. Throws UsageError for any other extension.
void write_surface(const std::filesystem::path& path, const TriangleSurface& surface);

/// GeometryModule::close() for a soup from a file. Throws InputError for a polygon that folds back
/// onto itself.
Closing closing_of(const PolygonSoup& soup, bool repair);

/// Converts faces to triangles that bound a body: equal points are merged, faces are oriented
/// outward, polygons are triangulated; duplicate and degenerate faces are dropped. Throws
/// InputError for a surface that has a border (gives the number of edges and the places of
/// the holes) or intersects itself
/// (gives the number of pairs of triangles). With `repair`, each hole is filled and
/// self-intersections are accepted, with a warning for each; the region enclosed by several sheets
/// is inside. `repair_option`: how users ask for that, for messages. About 5 us per triangle; a
/// note says so beforehand for more than 100,000 of them.
TriangleSurface close_surface(const PolygonSoup& soup, bool repair, Diagnostics& diagnostics,
                              const std::string& repair_option = "--repair");

/// The surface of a solid: read_soup(), closed and oriented outward as by close_surface() without
/// repair; large ones are mostly sound, which does without CGAL. The same errors, as they concern a
/// solid that must have an inside. For more than 100,000 faces, `announce_long_work` is called
/// before the work that takes long, 2 us per triangle, or 5.
std::shared_ptr<const SolidSurface> read_solid(
    const std::filesystem::path& path, double scale = 1,
    const std::function<void(std::size_t faces)>& announce_long_work = {});

/// Whether a file has the extension of a surface that read_soup() reads.
bool is_surface_file(const std::filesystem::path& path);
/// "a hole of 12 edges, 0.3 m around, at [0, 0.1, 0.2] m".
std::string hole_text(const Hole& hole);

}  // namespace suture
