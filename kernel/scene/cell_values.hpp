// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kernel/scene/selection.hpp"
#include "suture/plugin.h"

namespace suture {

/// Values of a model's parameter or attribute that the scene does not give as one number: an array
/// of the mesh, or a table over regions.
struct CellValues {
  struct Part {
    Selection region;
    std::vector<double> value;
  };
  std::uint32_t attribute = 0;                  ///< its place in the model's list
  const suture_parameter* parameter = nullptr;  ///< whose values these are; else the start
  std::string path;                             ///< of the value
  std::string array;                            ///< name; empty: a table
  double scale = 1;                             ///< factor of the array's values
  std::vector<Part> parts;                      ///< the last one that contains a cell counts
  std::vector<double> elsewhere;                ///< empty: the parts must contain all cells
};

}  // namespace suture
