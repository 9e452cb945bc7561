// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/mesh/file_text.hpp"

// CGAL's readers trust their files: a header that lies costs them memory or the process,
// and a wrong number becomes "false". These passes go before them and say what and where.

namespace suture {

/// The header's grammar, and that the body holds what the header announces: every number
/// of a text finite, every corner of a face a point, every list within the file.
/// Throws InputError with a line, or in a binary body a byte. About 5 ns per byte.
void check_ply(const FileText& file);

/// Every point three finite numbers, every corner of a face a point, every list within the
/// file; nothing of BINARY and nOFF. Throws InputError with a line. About 5 ns per byte.
void check_off(const FileText& file);

/// Every point three finite numbers, every corner of a face a point. Returns the text as
/// CGAL understands it, byte for byte: tabs, line ends after '\' and lines of `l` (drawn
/// edges) are spaces. Throws InputError with a line. About 20 ns per byte.
std::string check_obj(const FileText& file);

}  // namespace suture
