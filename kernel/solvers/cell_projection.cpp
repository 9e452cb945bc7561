// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/cell_projection.hpp"

#include <algorithm>
#include <utility>

#include "kernel/solvers/clones.hpp"

namespace suture {
namespace {

constexpr std::size_t lanes = 8;

/// The nodes with a weight in some of 8 cells; weights[node * lanes + lane].
struct Weights {
  const double* values;
  Index nodes[8];
  std::size_t count;
};

/// A number for each of 8 cells.
typedef double Lanes __attribute__((vector_size(lanes * sizeof(double)), aligned(8), may_alias));

inline const Lanes* lanes_of(const double* values) {
  return reinterpret_cast<const Lanes*>(values);
}
inline Lanes* lanes_of(double* values) { return reinterpret_cast<Lanes*>(values); }

/// half = K P for one coarse node: 9 numbers per node of the cells, of 8 cells at once. K is
/// symmetric: its columns serve as its rows.
SUTURE_CLONES
void multiply_column(const double* matrix, const Weights& weights, std::size_t nodes,
                     double* half) {
  for (std::size_t n = 0; n < nodes; ++n) {
    Lanes sums[9]{};
    for (std::size_t k = 0; k < weights.count; ++k) {
      const Lanes weight = lanes_of(weights.values)[weights.nodes[k]];
      const Lanes* values = lanes_of(matrix) + n * nodes * 9 + weights.nodes[k] * 3;
      for (std::size_t c = 0; c < 9; ++c) sums[c] += weight * values[c / 3 * nodes * 3 + c % 3];
    }
    for (std::size_t c = 0; c < 9; ++c) lanes_of(half)[n * 9 + c] = sums[c];
  }
}

/// block = P^T half for one coarse node, of 8 cells at once: to out, out + stride, ... in the order
/// of BlockRows. Only unrolled loops keep the sums in registers.
SUTURE_CLONES
void multiply_row(const Weights& weights, const double* half, double* out, std::size_t stride) {
  Lanes sums[9]{};
  for (std::size_t k = 0; k < weights.count; ++k) {
    const Lanes weight = lanes_of(weights.values)[weights.nodes[k]];
    const Lanes* values = lanes_of(half) + weights.nodes[k] * 9;
#pragma GCC unroll 9
    for (std::size_t c = 0; c < 9; ++c) sums[c] += weight * values[c % 3 * 3 + c / 3];
  }
  // The transpose of the first 8 rows: pairs of numbers, of pairs, of fours.
  Lanes two[8], four[8];
#pragma GCC unroll 4
  for (std::size_t c = 0; c < 8; c += 2) {
    two[c] = __builtin_shufflevector(sums[c], sums[c + 1], 0, 8, 2, 10, 4, 12, 6, 14);
    two[c + 1] = __builtin_shufflevector(sums[c], sums[c + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
#pragma GCC unroll 4
  for (std::size_t c = 0; c < 4; ++c) {
    const std::size_t low = c / 2 * 4 + c % 2;
    four[low] = __builtin_shufflevector(two[low], two[low + 2], 0, 1, 8, 9, 4, 5, 12, 13);
    four[low + 2] = __builtin_shufflevector(two[low], two[low + 2], 2, 3, 10, 11, 6, 7, 14, 15);
  }
#pragma GCC unroll 4
  for (std::size_t l = 0; l < 4; ++l) {
    *lanes_of(out + l * stride) =
        __builtin_shufflevector(four[l], four[l + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    *lanes_of(out + (l + 4) * stride) =
        __builtin_shufflevector(four[l], four[l + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
#pragma GCC unroll 8
  for (std::size_t l = 0; l < lanes; ++l) out[l * stride + 8] = sums[8][l];
}

/// to += factor * from.
SUTURE_CLONES
void add_values(double factor, const double* from, double* to, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) to[i] += factor * from[i];
}

/// Adds factor * values to the blocks of a row at some places.
SUTURE_CLONES
void add_blocks(double factor, const double* values, std::size_t step, const Index* places,
                std::size_t count, double* blocks) {
  for (std::size_t k = 0; k < count; ++k, values += step, step += 9) {
    double* const block = blocks + std::size_t{places[k]} * 9;
    *lanes_of(block) += factor * *lanes_of(values);
    block[8] += factor * values[8];
  }
}

/// The place of the block (a, b), a <= b, among those of the upper triangle, column by column.
std::size_t upper(std::size_t a, std::size_t b) { return b * (b + 1) / 2 + a; }

}  // namespace

CellProjection::CellProjection(const Interpolation& interpolation,
                               const std::vector<std::uint8_t>& free, Index coarse_nodes, Add add)
    : p_(interpolation), free_(free), add_(std::move(add)), place_(coarse_nodes) {}

void CellProjection::subtract(const CellTangents& cells, std::span<const float> weights) {
  list_nodes(cells);
  set_weights(cells);
  project(free_part(cells), cells.nodes);
  for (std::size_t first = 0, end = 0; first < cells.cells; first = end) {
    for (end = first + 1; end < cells.cells && lists_[end] == lists_[first];) ++end;
    collect(first, end, end == cells.cells, weights);
  }
}

void CellProjection::list_nodes(const CellTangents& cells) {
  width_ = 0;
  for (std::size_t l = 0; l < cells.cells; ++l) {
    list_nodes({cells.vertices + l * cells.nodes, cells.nodes}, lists_[l]);
    width_ = std::max(width_, lists_[l].size());
  }
}

void CellProjection::list_nodes(std::span<const Index> vertices, std::vector<Index>& list) {
  list.clear();
  for (const Index v : vertices)
    for (Index i = p_.begin[v]; i < p_.begin[v + 1]; ++i) {
      const Index node = p_.node[i];
      if (place_[node] < list.size() && list[place_[node]] == node) continue;
      place_[node] = static_cast<Index>(list.size());
      list.push_back(node);
    }
  std::ranges::sort(list);
}

void CellProjection::set_weights(const CellTangents& cells) {
  weights_.assign(width_ * cells.nodes * lanes, 0.0);
  used_.assign(width_, 0);
  for (std::size_t l = 0; l < cells.cells; ++l) set_weights(cells, l);
}

void CellProjection::set_weights(const CellTangents& cells, std::size_t lane) {
  const std::vector<Index>& list = lists_[lane];
  for (std::size_t at = 0; at < list.size(); ++at) place_[list[at]] = static_cast<Index>(at);
  for (Index n = 0; n < cells.nodes; ++n) {
    const Index v = cells.vertices[lane * cells.nodes + n];
    for (Index i = p_.begin[v]; i < p_.begin[v + 1]; ++i) {
      const std::size_t at = place_[p_.node[i]];
      weights_[(at * cells.nodes + n) * lanes + lane] = double{p_.weight[i]};
      used_[at] |= static_cast<std::uint8_t>(1u << n);
    }
  }
}

/// The matrices without the rows and columns of components that are not free.
const double* CellProjection::free_part(const CellTangents& cells) {
  const std::size_t size = std::size_t{cells.nodes} * 3;
  bool is_copied = false;
  for (std::size_t l = 0; l < cells.cells; ++l)
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t v = cells.vertices[l * cells.nodes + i / 3];
      if (free_[v * 3 + i % 3]) continue;
      if (!is_copied) matrix_.assign(cells.values, cells.values + size * size * lanes);
      is_copied = true;
      for (std::size_t j = 0; j < size; ++j)
        matrix_[(i * size + j) * lanes + l] = matrix_[(j * size + i) * lanes + l] = 0;
    }
  return is_copied ? matrix_.data() : cells.values;
}

void CellProjection::project(const double* matrix, Index nodes) {
  half_.resize(std::size_t{nodes} * 9 * lanes);
  const std::size_t stride = upper(0, width_) * 9;
  coarse_.resize(stride * lanes);
  const auto weights = [&](std::size_t place) {
    Weights result{weights_.data() + place * nodes * lanes, {}, 0};
    for (Index n = 0; n < nodes; ++n)
      if ((used_[place] >> n & 1) != 0) result.nodes[result.count++] = n;
    return result;
  };
  for (std::size_t b = 0; b < width_; ++b) {
    multiply_column(matrix, weights(b), nodes, half_.data());
    for (std::size_t a = 0; a <= b; ++a)
      multiply_row(weights(a), half_.data(), coarse_.data() + upper(a, b) * 9, stride);
  }
}

/// Cells first .. end - 1 have the same coarse nodes, and perhaps those that follow if they are the
/// `last` of a batch.
void CellProjection::collect(std::size_t first, std::size_t end, bool is_last,
                             std::span<const float> weights) {
  const std::vector<Index>& nodes = lists_[first];
  const auto values = [&](std::size_t l) { return coarse_.data() + l * upper(0, width_) * 9; };
  const auto factor = [&](std::size_t l) { return weights.empty() ? -1 : -double{weights[l]}; };
  if (nodes != pending_nodes_) {
    finish();
    if (end == first + 1 && !is_last) return add_(nodes, factor(first), values(first));
    pending_nodes_ = nodes;
    pending_.assign(upper(0, nodes.size()) * 9, 0.0);
  }
  for (std::size_t l = first; l < end; ++l)
    add_values(factor(l), values(l), pending_.data(), pending_.size());
}

void CellProjection::finish() {
  if (!pending_nodes_.empty()) add_(pending_nodes_, 1, pending_.data());
  pending_nodes_.clear();
  pending_.clear();
}

UpperSum::UpperSum(BlockRows<double>& sum)
    : sum_(sum), diagonal_(sum.pattern().rows()), number_(sum.pattern().rows()) {
  const BlockPattern& pattern = sum.pattern();
  for (Index row = 0; row < pattern.rows(); ++row) {
    const auto columns = pattern.row(row);
    const auto found = std::ranges::lower_bound(columns, row) - columns.begin();
    diagonal_[row] = pattern.begin[row] + static_cast<Index>(found);
  }
}

/// The places of the blocks are those of the nodes' numbers among the columns; no branch depends on
/// a column.
void UpperSum::add(std::span<const Index> nodes, double factor, const double* values) {
  const BlockPattern& pattern = sum_.pattern();
  targets_.resize(nodes.size() + 1);
  for (std::size_t k = 0; k < nodes.size(); ++k) number_[nodes[k]] = static_cast<Index>(k + 1);
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    const Index row = nodes[a];
    for (Index i = diagonal_[row]; i < pattern.begin[row + 1]; ++i)
      targets_[number_[pattern.column[i]]] = i;
    add_blocks(factor, values + upper(a, a) * 9, (a + 1) * 9, targets_.data() + a + 1,
               nodes.size() - a, sum_.block(0));
  }
  for (const Index node : nodes) number_[node] = 0;
}

void KeptBlocks::keep(std::span<const Index> nodes, double factor, const double* values) {
  entries_.push_back({nodes.size(), factor});
  nodes_.insert(nodes_.end(), nodes.begin(), nodes.end());
  values_.insert(values_.end(), values, values + upper(0, nodes.size()) * 9);
}

void KeptBlocks::add_to(UpperSum& sum) {
  const Index* node = nodes_.data();
  const double* values = values_.data();
  for (const Entry& entry : entries_) {
    sum.add({node, entry.nodes}, entry.factor, values);
    node += entry.nodes;
    values += upper(0, entry.nodes) * 9;
  }
  entries_.clear();
  nodes_.clear();
  values_.clear();
}

}  // namespace suture
