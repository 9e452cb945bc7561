// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/geometry/surface.hpp"
#include "kernel/mesh/file_text.hpp"

// Readers of surfaces as texts. What is wrong is said with its line, or in a binary body
// its byte; no count is believed that the file cannot hold.

namespace suture {

/// Lines other than `v` and `f` are known but passed. Throws InputError: a point that is not three
/// finite numbers, a corner that is no point, a line that begins with no word of the format.
PolygonSoup read_obj(const FileText& file);

/// Throws InputError: a number that is none, a corner that is no point, a binary file, points of
/// other than three coordinates.
PolygonSoup read_off(const FileText& file);

/// Text or binary; whatever else the elements hold is passed. Throws InputError: a wrong header, a
/// number that is none, a corner that is no point, points without x, y or z, faces without corners.
PolygonSoup read_ply(const FileText& file);

}  // namespace suture
