// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "kernel/base/diagnostics.hpp"
#include "kernel/mesh/file_text.hpp"
#include "kernel/mesh/mesh_file.hpp"

// The readers behind read_mesh, one per format. Each returns points, hexahedra in the order X0..X7,
// sets, arrays, and the numbers of skipped cells; indices are in range and coordinates finite. Each
// throws InputError with a line or byte.

namespace suture {

Mesh read_medit(const FileText& file, const MeshWants& wants, Diagnostics& diagnostics);
Mesh read_gmsh(const FileText& file, const MeshWants& wants, Diagnostics& diagnostics);
Mesh read_vtk_legacy(const FileText& file, const MeshWants& wants, Diagnostics& diagnostics);
Mesh read_vtu(const FileText& file, const MeshWants& wants, Diagnostics& diagnostics);

using Sets = std::map<std::string, std::vector<Index>>;

/// One set "prefix v" for each value v, and for 0 if `with_zero`. More than 4,096 different values
/// are not treated as labels: no set is made, and a warning says so.
void add_sets_by_value(Sets& sets, const std::string& prefix,
                       const std::vector<std::int64_t>& values, bool with_zero,
                       const std::string& source, Diagnostics& diagnostics);

/// Throws InputError unless `count` points or elements can be numbered with 32 bits.
void check_count(const FileText& file, std::uint64_t count, const char* what);

/// For read_shape().
void warn_of_curved_cells(const FileText& file, Diagnostics& diagnostics);

/// The message for higher-order hexahedra.
std::string too_many_nodes(std::size_t nodes);

}  // namespace suture
