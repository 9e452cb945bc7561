// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <string_view>
#include <vector>

#include "kernel/attributes/column.hpp"

namespace suture {

/// The cells of one dimension that a table describes, in the order of its rows.
/// All cells of the complex (row = cell) or those of a model's region.
class CellSet {
 public:
  CellSet() = default;
  static CellSet all(Index count);
  static CellSet of(std::vector<Index> cells, Index cell_count);

  Index size() const { return size_; }
  bool is_all() const { return all_; }
  Index cell(Index row) const { return all_ ? row : cells_[row]; }
  Index row(Index cell) const { return all_ ? cell : row_of_[cell]; }  ///< or `none`
  std::span<const Index> cells() const { return cells_; }  ///< empty if is_all()
  /// A cell that an operation made. Its row is the last.
  void append(Index cell);

 private:
  bool all_ = true;
  Index size_ = 0;
  std::vector<Index> cells_;
  std::vector<Index> row_of_;
};

/// One table per cell dimension (the kernel's own, and one per instance of a
/// model): a set of cells and a column per attribute.
struct Table {
  int dimension = 0;
  CellSet cells;
  std::deque<Column> columns;  ///< deque: references stay valid

  Column& add(ColumnSpec spec);
  Column* find(std::string_view name);
};

}  // namespace suture
