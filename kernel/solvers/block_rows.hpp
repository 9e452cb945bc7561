// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <vector>

#include "kernel/base/aligned.hpp"
#include "kernel/base/parallel.hpp"
#include "kernel/solvers/coarsening.hpp"

namespace suture {

/// The places of the blocks of a symmetric matrix with 3 x 3 blocks, one row of blocks per node:
/// nodes that share a cell.
struct BlockPattern {
  std::vector<Index> begin, column;  ///< columns ascend in every row

  Index rows() const { return static_cast<Index>(begin.size() - 1); }
  std::span<const Index> row(Index node) const {
    return std::span(column).subspan(begin[node], begin[node + 1] - begin[node]);
  }
};
BlockPattern pattern_of(const NodeGraph& graph);
/// The pattern with more cells.
BlockPattern extended(const BlockPattern& pattern, const NodeGraph& cells);

/// The blocks of a pattern, column by column: block[3 j + i] is row i, column j.
template <class Real>
class BlockRows {
 public:
  static constexpr std::size_t block_size = 9;

  BlockRows() = default;
  explicit BlockRows(const BlockPattern& pattern)
      : pattern_(&pattern), values_(pattern.column.size() * block_size + padding) {}

  const BlockPattern& pattern() const { return *pattern_; }
  Real* block(std::size_t place) { return values_.data() + place * block_size; }
  const Real* block(std::size_t place) const { return values_.data() + place * block_size; }
  std::size_t bytes() const { return values_.size() * sizeof(Real); }

  /// Adds blocks(column) to the row of a node for some of its columns, which ascend.
  template <class Blocks>
  void add_row(Index node, std::span<const Index> columns, const Blocks& blocks) {
    const Index* place = pattern_->column.data() + pattern_->begin[node];
    for (std::size_t k = 0; k < columns.size(); ++k) {
      while (*place != columns[k]) ++place;
      Real* to = block(static_cast<std::size_t>(place - pattern_->column.data()));
      blocks(k, to);
    }
  }

 private:
  static constexpr std::size_t padding = 4;  ///< a product loads 4 values at the last column

  const BlockPattern* pattern_ = nullptr;
  AlignedVector<Real> values_;
};

/// Copies the blocks above the diagonal below it, and makes those on it symmetric.
void mirror(BlockRows<double>& a);

/// y = A x, in rows of 4 (single_vector.hpp). `x` and `y` must differ.
void multiply(const BlockRows<float>& a, const float* x, float* y, const Workers* workers);

/// The same matrix in single precision.
BlockRows<float> in_single(const BlockRows<double>& a, const Workers* workers);

}  // namespace suture
