// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kernel/base/types.hpp"
#include "kernel/base/zeroed_vector.hpp"
#include "suture/plugin.h"

namespace suture {

class Archive;
class Column;

/// A row of a table became two.
struct RowSplit {
  Index old_row, new_row;
};

/// Declaration of a column; for a plugin's attribute, with the same terms as in plugin.h.
struct ColumnSpec {
  std::string name, unit, doc;
  int components = 1;
  suture_policy policy = SUTURE_COPY;
  double initial = 0;
  std::uint32_t flags = 0;  ///< suture_attribute_flag
  /// Instead of `policy`, for columns of the kernel: called once for each part
  /// that left a cell, with the rows of the part that stayed and of the new one.
  std::function<void(Column&, Index old_row, Index new_row)> on_split;
};

/// That of a plugin's attribute.
ColumnSpec spec_of(const suture_attribute& attribute);

/// One attribute of the cells of one dimension, contiguous doubles.
///
/// Vertices (dimension 0) are stored in rows: `stride()` doubles per vertex, which is 4
/// for vectors so that a gather loads one aligned half cache line.
/// Cells of dimension 1..3 are stored in blocks of 8 cells, lane-fastest, so that a
/// functor reads its columns without copying: block(b)[component*8 + lane].
/// Lanes after the last row repeat it, so a functor never reads garbage.
/// A constant column holds one block, whatever its length.
///
/// Memory per row: 8 B x stride() (dimension 0; a 3-vector takes 32 B), 8 B x
/// components (dimension 1..3), nothing if constant; twice that with
/// SUTURE_TRIAL. Address space for the same number of rows is reserved in addition, so
/// that the first cuts copy nothing; its pages use memory only once rows use them.
///
/// Pointers are valid until the next resize(), expansion, compress() or accept().
class Column {
 public:
  static constexpr Index lanes = SUTURE_LANES;
  using Values = ZeroedVector<double>;

  Column(ColumnSpec spec, int dimension);

  const ColumnSpec& spec() const { return spec_; }
  int dimension() const { return dimension_; }
  Index size() const { return size_; }
  bool is_constant() const { return constant_; }
  int stride() const { return stride_; }  ///< doubles from row to row, dimension 0

  /// New rows get spec().initial, or the value of a constant column.
  /// O(new rows), unless the reserve is used up.
  void resize(Index rows);
  /// Reserves room for so many new rows and touches its pages. O(rows).
  void make_room(Index rows);
  double get(Index row, int component) const { return data_[stored(row, component)]; }
  /// Expands a constant column if the value differs from it.
  void set(Index row, int component, double value);
  /// Appends the new rows of the splits, in this order: copies of all components of the
  /// old rows, also in the trial copy.
  void append_copies(std::span<const RowSplit> splits);
  void scale_row(Index row, double factor);  ///< also in the trial copy
  /// Moves row `to` by `weight` (0..1) towards row `from`, also in the trial copy: equal
  /// values keep their bits, and a weight of 1 gives the values of `from`.
  void mix_row(Index to, Index from, double weight);
  void add_row(Index to, Index from);  ///< row `to` += row `from`, also in the trial copy
  void fill(double value);             ///< every row and component; not the trial copy
  /// Makes a column of cells of dimension 1..3 constant; `block` is as block(0).
  void fill(std::span<const double> block);

  double* rows() { return data_.data(); }  ///< dimension 0, never constant
  const double* rows() const { return data_.data(); }
  Index block_count() const { return (size_ + lanes - 1) / lanes; }
  /// Cells 8b..8b+7, dimension 1..3; the same address for every b if constant.
  const double* block(Index b) const { return data_.data() + (constant_ ? 0 : block_offset(b)); }
  double* block(Index b);  ///< expands a constant column

  /// The offset of a component of a row in rows() or block(0) of a column that is not
  /// constant; the next component is component_step() further on.
  std::size_t offset(Index row) const {
    return dimension_ == 0 ? std::size_t{row} * static_cast<std::size_t>(stride_)
                           : block_offset(row / lanes) + row % lanes;
  }
  std::size_t component_step() const { return dimension_ == 0 ? 1 : lanes; }

  void expand();
  /// Repeats the last row in the lanes after it; to be called after writing through block().
  void pad();
  /// Stores a column once if, in every component, its rows agree within
  /// `relative` times the largest magnitude in the column: the first row replaces
  /// all others, which changes no value by more than that bound.
  /// Returns true if it is constant now. Dimension 1..3, no trial copy.
  bool compress(double relative);

  /// The trial copy that functors write (SUTURE_TRIAL): same layout. A rejected step
  /// needs no call: the next evaluation writes every row again.
  bool has_trial() const { return (spec_.flags & SUTURE_TRIAL) != 0; }
  double* trial_rows() { return trial_.data(); }
  double* trial_block(Index b) { return trial_.data() + block_offset(b); }
  double trial(Index row, int component) const { return trial_[stored(row, component)]; }
  void accept() { data_.swap(trial_); }  ///< the trial values become the values
  /// The values; with cells, also the number of rows and the trial copy.
  void state(Archive& archive);
  /// Returns the memory of the values and continues on a copy of it: pointers into it stay valid as
  /// long as the caller keeps it, and show the values of now.
  Values hand_over();
  /// Sets the trial copy of a row that will not be visited for a while: the row keeps its
  /// values through all steps that are accepted meanwhile.
  void hold_row(Index row);

 private:
  std::size_t block_offset(Index b) const {
    return std::size_t{b} * static_cast<std::size_t>(spec_.components) * lanes;
  }
  std::size_t stored(Index row, int component) const {
    return (constant_ ? 0 : offset(row)) + static_cast<std::size_t>(component) * component_step();
  }
  std::size_t storage(Index rows) const;
  void grow(Values& data, Index rows) const;
  void pad(Values& data) const;
  void copy_rows(Values& data, std::span<const RowSplit> splits) const;

  ColumnSpec spec_;
  int dimension_;
  int stride_;
  Index size_ = 0;
  bool constant_;
  Values data_, trial_;
};

}  // namespace suture
