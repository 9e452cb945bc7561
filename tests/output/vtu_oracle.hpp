// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace suture {

/// The contents of a .vtu or .vtp file according to VTK's own reader; behind a plain struct so that
/// only one translation unit includes VTK.
struct VtuContents {
  struct Array {
    int components = 0;
    std::vector<std::string> component_names;
    std::vector<double> values;
  };
  std::vector<std::array<double, 3>> points;
  std::vector<int> types;
  std::vector<std::vector<long>> cells;
  std::map<std::string, Array> point_arrays, cell_arrays, field_arrays;
  std::string provenance;
  std::string global_point_ids;  ///< name of the array that is marked so
};

VtuContents read_with_vtk(const std::filesystem::path& path);

}  // namespace suture
