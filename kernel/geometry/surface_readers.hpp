// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/geometry/surface.hpp"
#include "kernel/mesh/file_text.hpp"

// Readers of surface files. Errors name the line, or the byte in binary data; a count that exceeds
// the length of the file is refused.

namespace suture {

/// Lines of the format other than `v` and `f` are skipped. Throws InputError for a point that is
/// not three finite numbers, a corner that is not a valid point, and a line that begins with an
/// unknown word.
PolygonSoup read_obj(const FileText& file);

/// Throws InputError for a malformed number, a corner that is not a valid point, a binary file, and
/// points that do not have three coordinates.
PolygonSoup read_off(const FileText& file);

/// Text or binary; other properties of the elements are skipped. Throws InputError for an invalid
/// header, a malformed number, a corner that is not a valid point, points without x, y or z, and
/// faces without corners.
PolygonSoup read_ply(const FileText& file);

/// Text or binary: a file with the length of a binary file is binary, whatever it begins with.
/// Equal points get one number. Throws InputError for a file that is truncated (text without
/// 'endsolid' counts as truncated), bytes behind the triangles, and decimal commas.
PolygonSoup read_stl(const FileText& file);

}  // namespace suture
