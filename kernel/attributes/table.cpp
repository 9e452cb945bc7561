// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/table.hpp"

#include <cassert>
#include <utility>

#include "kernel/base/archive.hpp"
#include "kernel/base/error.hpp"

namespace suture {

CellSet CellSet::all(Index count) {
  CellSet set;
  set.size_ = count;
  return set;
}

CellSet CellSet::of(std::vector<Index> cells, Index cell_count) {
  CellSet set;
  set.all_ = false;
  set.size_ = static_cast<Index>(cells.size());
  set.cells_ = std::move(cells);
  set.row_of_.assign(cell_count, none);
  for (Index row = 0; row < set.size_; ++row) set.row_of_[set.cells_[row]] = row;
  return set;
}

void CellSet::place(Index cell, Index row) {
  if (cell >= row_of_.size()) row_of_.resize(cell + 1, none);
  row_of_[cell] = row;
}

void CellSet::append(Index cell) {
  assert(!all_ && !contains(cell));
  cells_.push_back(cell);
  place(cell, size_++);
  live_.resize(size_);
}

void CellSet::append_all(Index count) {
  assert(all_);
  size_ += count;
  live_.resize(size_);
}

void CellSet::rename(Index from, Index to) {
  assert(!all_ && contains(from) && !contains(to));
  const Index row = row_of_[from];
  row_of_[from] = none;
  cells_[row] = to;
  place(to, row);
}

void CellSet::remove(Index cell) {
  assert(contains(cell));
  live_.kill(row(cell), size_);
  if (!all_) row_of_[cell] = none;
}

void LiveMask::state(Archive& archive) {
  archive("blocks", blocks_);
  archive("dead", dead_);
}

void CellSet::state(Archive& archive) {
  bool all = all_;
  archive("all", all);
  archive.require(all == all_, "the cells of the region differ");
  archive("size", size_);
  if (!all_) {
    archive("cells", cells_);
    archive("rows", row_of_);
    archive.require(cells_.size() == size_, "the number of cells does not match");
  }
  archive("live", live_);
  archive.require(live_.fits(size_), "the number of rows does not match the mask of live rows");
}

Column& Table::add(ColumnSpec spec) {
  if (find(spec.name))
    throw InputError("attribute '" + spec.name + "' of dimension " + std::to_string(dimension) +
                     " is declared twice; give each its own name");
  Column& column = columns.emplace_back(std::move(spec), dimension);
  column.resize(cells.size());
  return column;
}

Column* Table::find(std::string_view name) {
  for (Column& column : columns)
    if (column.spec().name == name) return &column;
  return nullptr;
}

}  // namespace suture
