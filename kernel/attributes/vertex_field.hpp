// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>

#include "kernel/attributes/column.hpp"

namespace suture {

/// An unknown on vertices (SUTURE_FIELD), of all models that declare it. Its columns have a row per
/// vertex and are the kernel's, so they follow splits, merges and removals as positions do.
struct VertexField {
  std::string name, unit;
  Column* values = nullptr;
  bool is_rising = false;  ///< in a step (SUTURE_RISING)
  // Sums of what models contribute; nullptr: no model does.
  Column* capacity = nullptr;
  Column* relaxation = nullptr;  ///< SUTURE_RELAXATION
  Column* rate = nullptr;        ///< SUTURE_FIELD_RATE; nullptr: no model declares it

  std::array<Column*, 2> sums() const { return {capacity, relaxation}; }
};

}  // namespace suture
