// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/attributes/policies.hpp"

#include <algorithm>

#include "kernel/attributes/shape.hpp"

namespace suture {
namespace {

/// An element of the region is incident to the cell at position `i` of the stars.
bool has_member(const Stars& stars, Index i, const TouchedElements& touched) {
  for (Index j = stars.offsets[i]; j < stars.offsets[i + 1]; ++j)
    if (touched.slot(stars.darts[j] / hexahedron::darts) != none) return true;
  return false;
}

bool is_shared(const Column& column) {
  return column.spec().policy == SUTURE_SHARE && !column.spec().on_split;
}

}  // namespace

bool SplitPolicies::weighs(const Table& table) {
  return std::ranges::any_of(table.columns, is_shared);
}

void SplitPolicies::apply(Table& table, const CellComplex& complex, const RestPlaces& rest,
                          const TouchedElements& touched, const TopologyChange& change) {
  const auto dimension = static_cast<std::size_t>(table.dimension);
  const std::span<const Split> splits = change.splits[dimension];
  const Stars& stars = change.stars[dimension];
  rows_.clear();
  if (splits.empty()) return;
  const bool weighed = weighs(table);
  if (weighed || !table.cells.is_all()) find_stars(stars, complex.count(table.dimension));
  if (table.cells.is_all()) {
    table.cells.append_all(static_cast<Index>(splits.size()));
    if (table.columns.empty()) return;
    rows_.resize(splits.size());
    std::ranges::transform(splits, rows_.begin(), [](const Split& s) {
      return RowSplit{s.old_cell, s.new_cell};
    });
  } else {
    split_region(table.cells, splits, stars, touched);
  }
  for (Column& column : table.columns)
    if (!is_shared(column)) follow(column, table.cells.size());
  if (!weighed) return;
  weigh(table.cells, rest, touched, stars);  // needs the new rows of `rest`
  for (Column& column : table.columns)
    if (is_shared(column)) follow(column, table.cells.size());
}

void SplitPolicies::follow(Column& column, Index rows) const {
  if (column.spec().on_split) {
    column.resize(rows);
    for (const RowSplit& s : rows_) column.spec().on_split(column, s.old_row, s.new_row);
    return;
  }
  switch (column.spec().policy) {
    case SUTURE_COPY:
      column.append_copies(rows_);
      return;
    case SUTURE_ZERO:
      column.resize(rows);
      if (!column.is_constant() && column.spec().initial == 0) return;  // as new rows are
      for (const RowSplit& s : rows_)
        for (int c = 0; c < column.spec().components; ++c) column.set(s.new_row, c, 0);
      return;
    case SUTURE_SHARE:
      column.append_copies(rows_);
      for (std::size_t i = 0; i < rows_.size(); ++i) {
        column.scale_row(rows_[i].new_row, new_share_[i]);
        column.scale_row(rows_[i].old_row, old_share_[i]);
      }
      return;
    case SUTURE_FROM_VOLUMES:
      column.resize(rows);
      return;  // every touched row is summed again, the new ones among them
  }
}

void SplitPolicies::find_stars(const Stars& stars, Index cell_count) {
  star_of_.reserve(cell_count);
  for (Index i = 0; i < stars.cells.size(); ++i) star_of_[stars.cells[i]] = i;
}

// A region of two elements (#) beside others (.), and the cell between them:
//
//     # | .              # |   | .     the part that keeps the number has an
//     --c--     cut      --c   d--     element of the region: a new row for e
//     # | .    ------>   # |   | .     if it has one too, none for d
//
//     . | #              . |   | #     it has none: the row continues as d, the
//     --c--     ----->   --c   d--     first part that has one, with all values
//     . | .              . |   | .
void SplitPolicies::split_region(CellSet& cells, std::span<const Split> splits, const Stars& stars,
                                 const TouchedElements& touched) {
  source_row_.resize(stars.cells.size());
  for (const Split& s : splits) source_row_[star_of_[s.old_cell]] = cells.row(s.old_cell);
  for (const Split& s : splits) {
    if (!has_member(stars, star_of_[s.new_cell], touched)) continue;
    const Index old_star = star_of_[s.old_cell];
    if (cells.contains(s.old_cell) && !has_member(stars, old_star, touched)) {
      cells.rename(s.old_cell, s.new_cell);
    } else {
      cells.append(s.new_cell);
      rows_.push_back({source_row_[old_star], cells.size() - 1});
    }
  }
}

void SplitPolicies::weigh(const CellSet& cells, const RestPlaces& rest,
                          const TouchedElements& touched, const Stars& stars) {
  volumes_.clear();
  for (const Index e : touched.members()) volumes_.push_back(rest.volume(e));
  weights_.assign(stars.cells.size(), 0);
  for (Index i = 0; i < stars.cells.size(); ++i)
    for (Index j = stars.offsets[i]; j < stars.offsets[i + 1]; ++j) {
      const Index slot = touched.slot(stars.darts[j] / hexahedron::darts);
      if (slot != none) weights_[i] += volumes_[slot];
    }
  const auto star_of_row = [&](Index row) { return star_of_[cells.cell(row)]; };
  totals_ = weights_;
  for (const RowSplit& s : rows_)
    totals_[star_of_row(s.old_row)] += weights_[star_of_row(s.new_row)];
  new_share_.clear();
  for (const RowSplit& s : rows_)
    new_share_.push_back(weights_[star_of_row(s.new_row)] / totals_[star_of_row(s.old_row)]);
  old_share_.clear();
  for (const RowSplit& s : rows_) {
    double& total = totals_[star_of_row(s.old_row)];
    old_share_.push_back(total == 0 ? 1 : weights_[star_of_row(s.old_row)] / total);
    total = 0;  // later splits of this row find that it has been scaled
  }
}

}  // namespace suture
