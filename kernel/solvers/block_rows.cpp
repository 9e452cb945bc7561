// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/block_rows.hpp"

#include <Eigen/Core>
#include <algorithm>

#include "kernel/solvers/clones.hpp"
#include "kernel/solvers/single_vector.hpp"

namespace suture {
namespace {

/// Rows of blocks that a thread takes at once: about 30 us of work.
constexpr std::size_t row_chunk = 256;

/// The cells of every node, in compressed rows.
struct CellsOfNodes {
  explicit CellsOfNodes(const NodeGraph& graph)
      : begin(graph.nodes() + 1), cells(graph.cell_nodes.size()) {
    for (const Index node : graph.cell_nodes) ++begin[node];
    Index sum = 0;
    for (Index& b : begin) b = sum += b;
    for (std::size_t cell = graph.cells(); cell-- > 0;)
      for (const Index node : graph.cell(cell)) cells[--begin[node]] = static_cast<Index>(cell);
  }
  std::vector<Index> begin, cells;
};

SingleRow load(const float* from) {
  SingleRow result;
  std::memcpy(&result, from, sizeof result);
  return result;
}

/// Blocks lie one after the other: the fourth number of a column belongs to the next one.
SUTURE_CLONES
void multiply(const Index* begin, const Index* column, const float* block, const SingleRow* x,
              SingleRow* y, Index rows) {
  for (Index row = 0; row < rows; ++row) {
    // Two sums: consecutive products do not wait for each other.
    SingleRow even{}, odd{};
    Index i = begin[row];
    for (; i + 1 < begin[row + 1]; i += 2, block += 18) {
      const SingleRow a = x[column[i]], b = x[column[i + 1]];
      even += load(block) * a[0] + load(block + 3) * a[1] + load(block + 6) * a[2];
      odd += load(block + 9) * b[0] + load(block + 12) * b[1] + load(block + 15) * b[2];
    }
    if (i < begin[row + 1]) {
      const SingleRow a = x[column[i]];
      even += load(block) * a[0] + load(block + 3) * a[1] + load(block + 6) * a[2];
      block += 9;
    }
    even += odd;
    even[3] = 0;
    y[row] = even;
  }
}

}  // namespace

BlockPattern pattern_of(const NodeGraph& graph) {
  return extended({std::vector<Index>(graph.nodes() + 1), {}}, graph);
}

BlockPattern extended(const BlockPattern& pattern, const NodeGraph& cells) {
  const CellsOfNodes around(cells);
  BlockPattern result;
  result.begin.push_back(0);
  std::vector<Index> row_of(cells.nodes(), none);
  for (Index node = 0; node < cells.nodes(); ++node) {
    const auto add = [&](std::span<const Index> others) {
      for (const Index other : others)
        if (std::exchange(row_of[other], node) != node) result.column.push_back(other);
    };
    add(pattern.row(node));
    for (Index i = around.begin[node]; i < around.begin[node + 1]; ++i)
      add(cells.cell(around.cells[i]));
    std::sort(result.column.begin() + result.begin.back(), result.column.end());
    result.begin.push_back(static_cast<Index>(result.column.size()));
  }
  return result;
}

void mirror(BlockRows<double>& a) {
  const BlockPattern& p = a.pattern();
  using Block = Eigen::Map<Eigen::Matrix3d>;
  // The next block of every row below the diagonal: columns ascend.
  std::vector<Index> next(p.begin.begin(), p.begin.end() - 1);
  for (Index row = 0; row < p.rows(); ++row)
    for (Index i = next[row]; i < p.begin[row + 1]; ++i) {
      const Block block(a.block(i));
      if (p.column[i] == row)
        Block(a.block(i)) = (0.5 * (block + block.transpose())).eval();
      else
        Block(a.block(next[p.column[i]]++)) = block.transpose();
    }
}

void multiply(const BlockRows<float>& a, const float* x, float* y, const Workers* workers) {
  const BlockPattern& p = a.pattern();
  for_chunks(p.rows(), row_chunk, workers, [&](std::size_t first, std::size_t end, std::size_t) {
    multiply(&p.begin[first], p.column.data(), a.block(p.begin[first]),
             reinterpret_cast<const SingleRow*>(x), reinterpret_cast<SingleRow*>(y) + first,
             static_cast<Index>(end - first));
  });
}

BlockRows<float> in_single(const BlockRows<double>& a, const Workers* workers) {
  BlockRows<float> result(a.pattern());
  const BlockPattern& p = a.pattern();
  for_chunks(p.rows(), row_chunk, workers, [&](std::size_t first, std::size_t end, std::size_t) {
    std::transform(a.block(p.begin[first]), a.block(p.begin[end]), result.block(p.begin[first]),
                   [](double value) { return static_cast<float>(value); });
  });
  return result;
}

}  // namespace suture
