// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "kernel/base/aligned.hpp"
#include "kernel/base/types.hpp"
#include "suture/plugin.h"

namespace suture {

/// A column that only the rows from a first one on have, in blocks of 8 rows.
class PartColumn {
 public:
  explicit PartColumn(std::uint32_t components) : components_(components) {}

  /// Rows that are new, and those behind the last one in its block, are 0.
  void resize(Index first, Index rows) {
    first_block_ = first / SUTURE_LANES;
    values_.resize(((rows + SUTURE_LANES - 1) / SUTURE_LANES - first_block_) * block(), 0);
  }
  void set(Index row, std::span<const double> values) {
    for (std::size_t c = 0; c < values.size(); ++c) values_[place(row, c)] = values[c];
  }
  double get(Index row, std::size_t component) const { return values_[place(row, component)]; }
  std::uint32_t components() const { return components_; }
  /// Where row 0 would be: rows before the first block take no memory and must not be read.
  const double* data() const {
    const auto address = reinterpret_cast<std::uintptr_t>(values_.data());
    return reinterpret_cast<const double*>(address - first_block_ * block() * sizeof(double));
  }

 private:
  std::size_t block() const { return std::size_t{components_} * SUTURE_LANES; }
  std::size_t place(Index row, std::size_t component) const {
    return (row / SUTURE_LANES - first_block_) * block() + component * SUTURE_LANES +
           row % SUTURE_LANES;
  }

  std::uint32_t components_;
  std::size_t first_block_ = 0;
  AlignedVector<double> values_;
};

}  // namespace suture
