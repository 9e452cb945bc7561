// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "kernel/mesh/mesh.hpp"

namespace suture {

// VTK's own writers and readers, in a translation unit of their own.

enum class VtkEncoding {
  legacy_text,
  legacy_binary,
  text,
  inline_base64,
  appended_base64,
  appended_raw,
  lz4,
  zlib,
  lzma
};
inline constexpr VtkEncoding vtk_encodings[] = {VtkEncoding::legacy_text,
                                                VtkEncoding::legacy_binary,
                                                VtkEncoding::text,
                                                VtkEncoding::inline_base64,
                                                VtkEncoding::appended_base64,
                                                VtkEncoding::appended_raw,
                                                VtkEncoding::lz4,
                                                VtkEncoding::zlib,
                                                VtkEncoding::lzma};

/// Points, hexahedra, element sets (as byte arrays) and point ids.
void write_with_vtk(const std::filesystem::path& path, const Mesh& mesh, VtkEncoding encoding);

/// So many zeros as one compressed block.
std::string zlib_zeros(std::size_t bytes);

/// Points, hexahedra and byte arrays as sets, of a .vtk or .vtu file.
Mesh read_mesh_with_vtk(const std::filesystem::path& path);

}  // namespace suture
