// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "kernel/base/aligned.hpp"
#include "kernel/forces/term_capabilities.hpp"
#include "kernel/solvers/block_rows.hpp"

namespace suture {

/// Adds blocks to the upper triangle of a matrix.
class UpperSum {
 public:
  explicit UpperSum(BlockRows<double>& sum);

  /// Adds factor * values: a block for any two of some nodes, which ascend, a row before its
  /// column, column by column. The matrix must have these blocks.
  void add(std::span<const Index> nodes, double factor, const double* values);

 private:
  BlockRows<double>& sum_;
  std::vector<Index> diagonal_;  ///< of every row, the place of its block on the diagonal
  std::vector<Index> number_;    ///< of a node in add(), from 1 on; 0: it has none
  std::vector<Index> targets_;   ///< of the blocks of a row, by number; the first is not used
};

/// Arguments of UpperSum::add(), to be added later.
class KeptBlocks {
 public:
  void keep(std::span<const Index> nodes, double factor, const double* values);
  /// Keeps them no longer.
  void add_to(UpperSum& sum);

 private:
  struct Entry {
    std::size_t nodes;
    double factor;
  };
  std::vector<Entry> entries_;
  std::vector<Index> nodes_;
  std::vector<double> values_;
};

/// Computes P^T A P for cell matrices A, on the free components: parts of the operator of a coarse
/// level. Those of consecutive cells with the same coarse nodes are summed. Only blocks of the
/// upper triangle are computed.
class CellProjection {
 public:
  /// As UpperSum::add().
  using Add =
      std::function<void(std::span<const Index> nodes, double factor, const double* values)>;
  CellProjection(const Interpolation& interpolation, const std::vector<std::uint8_t>& free,
                 Index coarse_nodes, Add add);

  /// Subtracts, because cells come with the opposite sign. `weights`: of the cells; 1 if empty.
  void subtract(const CellTangents& cells, std::span<const float> weights = {});
  /// Adds what is still pending. To be called after the last cells.
  void finish();

 private:
  static constexpr std::size_t lanes = 8;

  void list_nodes(const CellTangents& cells);
  void list_nodes(std::span<const Index> vertices, std::vector<Index>& list);
  void set_weights(const CellTangents& cells);
  void set_weights(const CellTangents& cells, std::size_t lane);
  const double* free_part(const CellTangents& cells);
  void project(const double* matrix, Index nodes);
  void collect(std::size_t first, std::size_t end, bool is_last, std::span<const float> weights);

  const Interpolation& p_;
  const std::vector<std::uint8_t>& free_;
  Add add_;
  std::array<std::vector<Index>, lanes> lists_;  ///< coarse nodes of every cell, ascending
  std::size_t width_ = 0;                        ///< of the longest list
  AlignedVector<double> matrix_, weights_, half_;
  AlignedVector<double> coarse_;    ///< cell by cell, blocks as in pending_
  std::vector<Index> place_;        ///< of a coarse node in the list at hand; of others anything
  std::vector<std::uint8_t> used_;  ///< per place in the lists, a bit for each node with a weight
  std::vector<Index> pending_nodes_;
  std::vector<double> pending_;  ///< blocks of the upper triangle, column by column
};

}  // namespace suture
