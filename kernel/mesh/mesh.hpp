// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "kernel/base/types.hpp"

namespace suture {

/// Points and hexahedra from a file or a generator; only the syntax has been checked. The node
/// order is X0..X7 (converted from the order of the file by the reader); numbers are positions in
/// these vectors.
struct Mesh {
  std::string source;        ///< file name or "box 20 x 5 x 5", for messages
  std::vector<Vec3> points;  ///< m, after the scene's "scale", from `origin`
  Vec3 origin{};             ///< position in the scene of the origin of `points`, m
  std::vector<Hexahedron> hexahedra;
  /// Named sets of the file: Gmsh physical groups, Medit references ("ref 3"),
  /// VTK arrays of flags. Values are positions in `points` / `hexahedra`.
  std::map<std::string, std::vector<Index>> point_sets;
  std::map<std::string, std::vector<Index>> element_sets;
  /// The file's own numbers (Gmsh tags) where they are not 0, 1, 2, ...; else empty.
  std::vector<std::uint64_t> point_ids;
  std::vector<std::uint64_t> element_ids;
  /// Cells of other types in the file, which are not read: name -> count.
  std::map<std::string, std::size_t> skipped_cells;
};

}  // namespace suture
