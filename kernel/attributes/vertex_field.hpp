// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/attributes/column.hpp"

namespace suture {

/// An unknown on vertices (SUTURE_FIELD), of all models that declare it. Its columns have a row per
/// vertex and are the kernel's, so they follow splits, merges and removals as positions do.
struct VertexField {
  std::string name, unit;
  Column* values = nullptr;
  Column* capacity = nullptr;  ///< sums of what models contribute; nullptr: no model does
};

}  // namespace suture
