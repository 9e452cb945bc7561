// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/cell_projection.hpp"

#include <algorithm>

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

/// block = P^T half for one coarse node, of 8 cells at once. Only unrolled loops keep the sums in
/// registers.
SUTURE_CLONES
void multiply_row(const Weights& weights, const double* half, double* block) {
  Lanes sums[9]{};
  for (std::size_t k = 0; k < weights.count; ++k) {
    const Lanes weight = lanes_of(weights.values)[weights.nodes[k]];
    const Lanes* values = lanes_of(half) + weights.nodes[k] * 9;
#pragma GCC unroll 9
    for (std::size_t c = 0; c < 9; ++c) sums[c] += weight * values[c];
  }
#pragma GCC unroll 9
  for (std::size_t c = 0; c < 9; ++c) lanes_of(block)[c] = sums[c];
}

/// The place of the block (a, b), a <= b, among those of the upper triangle, column by column.
std::size_t upper(std::size_t a, std::size_t b) { return b * (b + 1) / 2 + a; }

}  // namespace

CellProjection::CellProjection(const Interpolation& interpolation,
                               const std::vector<std::uint8_t>& free, BlockRows<double>& sum)
    : p_(interpolation), free_(free), sum_(sum), place_(sum.pattern().rows()) {}

void CellProjection::subtract(const CellTangents& cells, std::span<const float> weights) {
  list_nodes(cells);
  set_weights(cells);
  project(free_part(cells), cells.nodes);
  for (std::size_t first = 0, end = 0; first < cells.cells; first = end) {
    for (end = first + 1; end < cells.cells && lists_[end] == lists_[first];) ++end;
    collect(first, end, weights);
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
  coarse_.resize(upper(0, width_) * 9 * lanes);
  const auto weights = [&](std::size_t place) {
    Weights result{weights_.data() + place * nodes * lanes, {}, 0};
    for (Index n = 0; n < nodes; ++n)
      if ((used_[place] >> n & 1) != 0) result.nodes[result.count++] = n;
    return result;
  };
  for (std::size_t b = 0; b < width_; ++b) {
    multiply_column(matrix, weights(b), nodes, half_.data());
    for (std::size_t a = 0; a <= b; ++a)
      multiply_row(weights(a), half_.data(), coarse_.data() + upper(a, b) * 9 * lanes);
  }
}

/// Cells first .. end - 1 have the same coarse nodes.
void CellProjection::collect(std::size_t first, std::size_t end, std::span<const float> weights) {
  if (lists_[first] != pending_nodes_) {
    finish();
    pending_nodes_ = lists_[first];
    pending_.assign(upper(0, pending_nodes_.size()) * 9, 0.0);
  }
  for (std::size_t l = first; l < end; ++l) {
    const double weight = weights.empty() ? 1 : double{weights[l]}, *lane = coarse_.data() + l;
    for (std::size_t i = 0; i < pending_.size(); ++i) pending_[i] -= weight * lane[i * lanes];
  }
}

void CellProjection::finish() {
  const std::span<const Index> nodes = pending_nodes_;
  for (std::size_t a = 0; a < nodes.size(); ++a)
    sum_.add_row(nodes[a], nodes.subspan(a), [&](std::size_t k, double* block) {
      const double* values = pending_.data() + upper(a, a + k) * 9;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) block[3 * j + i] += values[i * 3 + j];
    });
  pending_nodes_.clear();
}

}  // namespace suture
