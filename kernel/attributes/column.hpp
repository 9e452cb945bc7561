// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "kernel/base/aligned.hpp"
#include "kernel/base/types.hpp"
#include "suture/plugin.h"

namespace suture {

/// Declaration of a column; for a plugin's attribute the same words as there.
struct ColumnSpec {
  std::string name, unit, doc;
  int components = 1;
  suture_policy policy = SUTURE_COPY;
  double initial = 0;
  std::uint32_t flags = 0;                        ///< suture_attribute_flag
  suture_contribution_fn contribution = nullptr;  ///< with SUTURE_FROM_VOLUMES
};

/// One attribute of the cells of one dimension, contiguous doubles.
///
/// Vertices (dimension 0) lie in rows: `stride()` doubles per vertex, which is 4
/// for vectors so that a gather loads one aligned half cache line.
/// Cells of dimension 1..3 lie in blocks of 8 cells, lane-fastest, so that a
/// functor reads its columns without any copy: block(b)[component*8 + lane].
/// A constant column holds one block whatever its length.
class Column {
 public:
  Column(ColumnSpec spec, int dimension);

  const ColumnSpec& spec() const { return spec_; }
  int dimension() const { return dimension_; }
  Index size() const { return size_; }
  bool is_constant() const { return constant_; }
  int stride() const { return stride_; }  ///< doubles from row to row, dimension 0

  void resize(Index rows);  ///< new rows get spec().initial
  double get(Index row, int component) const;
  void set(Index row, int component, double value);  ///< expands a constant column

  double* rows() { return data_.data(); }  ///< dimension 0, never constant
  const double* rows() const { return data_.data(); }
  /// Cells 8b..8b+7, dimension 1..3; the same address for every b if constant.
  const double* block(Index b) const {
    return data_.data() + (constant_ ? 0 : std::size_t{b} * spec_.components * 8);
  }
  double* block(Index b);  ///< expands a constant column

  /// Stores a column whose rows agree within `relative` of its largest
  /// magnitude once. Returns true if it is constant now. Dimension 1..3.
  bool compress(double relative);

 private:
  ColumnSpec spec_;
  int dimension_;
  int stride_;
  Index size_ = 0;
  bool constant_ = false;
  AlignedVector<double> data_;
};

}  // namespace suture
