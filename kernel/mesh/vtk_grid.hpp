// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "kernel/base/types.hpp"
#include "kernel/mesh/mesh.hpp"

namespace suture {

/// An unstructured grid as stored by VTK: cells of every type, in VTK's node order.
struct VtkGrid {
  /// A one-component array of integers: labels, flags or ids.
  struct Labels {
    std::string name;
    bool of_cells = false;
    bool bytes = false;       ///< stored as bytes: flags if all are 0 or 1
    bool global_ids = false;  ///< marked by the file as the user's numbers
    std::vector<std::int64_t> values;
  };
  std::vector<Vec3> points;
  std::vector<std::int64_t> offsets;  ///< cell c has connectivity[offsets[c], offsets[c + 1])
  std::vector<std::int64_t> connectivity;
  std::vector<std::uint8_t> types;
  std::vector<Labels> labels;
  std::vector<MeshArray> arrays;  ///< "elements" stand for cells of every type

  MeshArray* find_array(const std::string& name, bool of_cells) {
    const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const MeshArray& a) {
      return a.name == name && a.of_elements == of_cells;
    });
    return found == arrays.end() ? nullptr : &*found;
  }
};

/// VTK's numbers for the cell types that are 8-node hexahedra.
inline constexpr std::uint8_t vtk_hexahedron = 12;
inline constexpr std::uint8_t vtk_voxel = 11;

}  // namespace suture
