// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "kernel/base/diagnostics.hpp"
#include "kernel/mesh/mesh.hpp"

namespace suture {

/// Whether the values of arrays of this name are to be read; an empty function stands for no array.
using WantsArray = std::function<bool(const std::string& name)>;
inline bool all_arrays(const std::string&) { return true; }

/// What a reader keeps of a file.
struct MeshWants {
  WantsArray array;
  bool all_solids = false;  ///< not hexahedra alone; see read_shape()

  bool wants_array(const std::string& name) const { return array && array(name); }
};

/// Reads Medit `.mesh` (ASCII), Gmsh `.msh` (2.x and 4.1, ASCII and binary), legacy `.vtk` (ASCII
/// and binary) and `.vtu`; the contents of the file take precedence over its extension. Coordinates
/// are multiplied by `scale`. Sets become named sets: Gmsh physical groups under their names
/// (unnamed: "physical surface 3"), Medit references as "ref 3" (of quadrilaterals: the points of
/// "quads ref 3"), integer arrays of VTK as "material 3", byte arrays of 0 and 1 under their own
/// name. Arrays of VTK (point and cell data) and Gmsh ($NodeData, $ElementData) are listed; their
/// values, integers included, are read for those that `wants` names. Other cells are skipped, with
/// one warning that gives their number. Throws InputError naming the file and the line or byte for
/// a file that is missing, empty, truncated or malformed, for a coordinate that is not finite, an
/// index out of range, hexahedra with more than 8 nodes, and a file without hexahedra (lists what
/// it contains). Memory is never allocated for a count that exceeds the length of the file. Cost
/// for a grid of a million hexahedra: 0.26 s Medit, 0.28 s Gmsh, 0.27 s .vtk in binary, 0.40 s .vtu
/// with LZ4 (processor time, sets included).
Mesh read_mesh(const std::filesystem::path& path, double scale, Diagnostics& diagnostics,
               const WantsArray& wants = {});

/// The same for a file whose cells tell only what the shape of a body is and what it consists of:
/// tetrahedra, pyramids and wedges are read, too, as hexahedra of which nodes coincide
/// (solid_cells.hpp). Of quadratic ones, only the corners are read, so that their edges become
/// straight; a warning says so. Throws InputError for a file without any of these cells.
Mesh read_shape(const std::filesystem::path& path, double scale, Diagnostics& diagnostics,
                const WantsArray& wants = {});

/// Writes `.vtu` (binary), `.vtk` (legacy 4.2, binary), `.mesh` (ASCII) or `.msh` (Gmsh 4.1, ASCII)
/// by the extension; coordinates are preserved exactly. Sets, arrays and source ids are kept as far
/// as the format supports them: Medit has one reference per point and element and no arrays, so
/// overlapping sets and arrays are lost (a warning names them). The file appears complete or not at
/// all. Throws UsageError for any other extension, IoError if it cannot be written.
void write_mesh(const std::filesystem::path& path, const Mesh& mesh, Diagnostics& diagnostics);

}  // namespace suture
