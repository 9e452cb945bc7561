// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "kernel/attributes/own_rest.hpp"
#include "kernel/attributes/table.hpp"
#include "kernel/attributes/touched.hpp"
#include "kernel/base/bulk.hpp"
#include "kernel/topology/cell_complex.hpp"

namespace suture {

/// Makes the rows and values of one table follow the splits of its cells. Work
/// space, kept between operations.
class SplitPolicies {
 public:
  /// True if a column of the table is divided by volumes.
  static bool weighs(const Table& table);

  /// New cells join `table` where an element of its region is incident to them;
  /// then the declared policy is applied to every column, except for the sums of
  /// SUTURE_FROM_VOLUMES (contributions.hpp).
  /// `touched`: the region's elements in the change; not needed for a table of all
  /// cells in which no column is divided by volumes.
  /// O(cells of the dimension in the change).
  void apply(Table& table, const CellComplex& complex, const RestPlaces& rest,
             const TouchedElements& touched, const TopologyChange& change);

  /// Makes room for as many splits of the cells of one dimension. O(splits).
  void make_room(Index splits) { suture::make_room(rows_, splits); }

  /// The rows that the last apply() added, in order; empty for a table without columns.
  std::span<const RowSplit> new_rows() const { return rows_; }

 private:
  void find_stars(const Stars& stars, Index cell_count);
  void follow(Column& column, Index rows) const;
  void split_region(CellSet& cells, std::span<const Split> splits, const Stars& stars,
                    const TouchedElements& touched);
  void weigh(const CellSet& cells, const RestPlaces& rest, const TouchedElements& touched,
             const Stars& stars);

  BulkVector<RowSplit> rows_;
  /// Fractions of the incident volume, per split. Of several splits of one row, the
  /// first has the fraction of the old row, the others have 1.
  std::vector<double> old_share_, new_share_;
  ZeroedIndices star_of_;  ///< cell -> position in Stars; read for its cells only
  std::vector<Index> source_row_;
  std::vector<double> volumes_, weights_, totals_;
};

}  // namespace suture
