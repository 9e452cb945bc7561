// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <span>
#include <string_view>
#include <vector>

#include "kernel/attributes/column.hpp"
#include "kernel/attributes/live_mask.hpp"

namespace suture {

/// The cells of one dimension that a table describes, in the order of its rows:
/// all cells of the complex (row = cell) or those of a model's region. A row whose
/// cell has left the set remains as a dead row, which loops skip (is_live()).
/// Memory: nothing for all cells, else 4 B per row and 4 B per cell of the complex;
/// a bit per row once a row is dead.
class CellSet {
 public:
  CellSet() = default;
  static CellSet all(Index count);
  /// Row i is cells[i]; the complex has `cell_count` cells.
  static CellSet of(std::vector<Index> cells, Index cell_count);

  Index size() const { return size_; }  ///< rows, dead ones included
  bool is_all() const { return all_; }
  bool is_live(Index row) const { return live_[row]; }
  Index live_count() const { return size_ - live_.dead(); }
  const LiveMask& live() const { return live_; }
  /// For a dead row, the cell that it had.
  Index cell(Index row) const { return all_ ? row : cells_[row]; }
  /// `none` if the cell is not in the set. A set of all cells does not check whether
  /// the cell still exists; contains() does.
  Index row(Index cell) const {
    if (all_) return cell;
    return cell < row_of_.size() ? row_of_[cell] : none;
  }
  bool contains(Index cell) const { return all_ ? live_[cell] : row(cell) != none; }
  std::span<const Index> cells() const { return cells_; }  ///< empty if is_all()
  /// Row of each cell or `none`, for loops over batches; empty if is_all().
  std::span<const Index> rows() const { return row_of_; }

  /// Adds a cell that an operation created. Its row is the last.
  void append(Index cell);
  /// Adds the next `count` cells of the complex to a set of all cells.
  void append_all(Index count);
  /// The row of `from` describes `to` from now on; `from` leaves the set.
  void rename(Index from, Index to);
  /// The cell leaves the set and its row dies.
  void remove(Index cell);
  void state(Archive& archive);

 private:
  void place(Index cell, Index row);

  bool all_ = true;
  Index size_ = 0;
  std::vector<Index> cells_;
  std::vector<Index> row_of_;
  LiveMask live_;
};

/// One table per cell dimension (the kernel's own, and one per instance of a
/// model): a set of cells and a column per attribute.
struct Table {
  int dimension = 0;
  CellSet cells;
  std::deque<Column> columns;  ///< deque: references stay valid
  /// Incident volume at rest of each row, m^3, if a column is divided by volumes
  /// (SUTURE_SHARE): determines what a removal leaves of it. Otherwise empty.
  std::vector<double> volumes;

  /// Adds a column for all rows. Throws InputError if the name is taken.
  Column& add(ColumnSpec spec);
  Column* find(std::string_view name);  ///< nullptr if there is none
};

}  // namespace suture
