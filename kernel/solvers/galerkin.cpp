// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/galerkin.hpp"

#include <algorithm>
#include <deque>
#include <optional>
#include <utility>

#include "kernel/solvers/cell_projection.hpp"

namespace suture {
namespace {

constexpr std::size_t block_size = BlockRows<double>::block_size;

void add_masses(const TangentMatrix& a, const Interpolation& p, BlockRows<double>& sum) {
  for (Index v = 0; v < p.fine_nodes(); ++v) {
    const double mass = a.mass_at(v);
    if (mass == 0 || p.begin[v] == p.begin[v + 1]) continue;
    const std::size_t size = p.begin[v + 1] - p.begin[v];
    std::vector<std::pair<Index, double>> shares(size);
    for (std::size_t i = 0; i < size; ++i)
      shares[i] = {p.node[p.begin[v] + i], p.weight[p.begin[v] + i]};
    std::ranges::sort(shares);
    std::vector<Index> columns(size);
    std::ranges::transform(shares, columns.begin(), [](const auto& s) { return s.first; });
    for (std::size_t i = 0; i < size; ++i)
      sum.add_row(columns[i], std::span(columns).subspan(i), [&](std::size_t k, double* block) {
        const double share = mass * shares[i].second * shares[i + k].second;
        for (std::size_t c = 0; c < 3; ++c)
          if (a.free()[std::size_t{v} * 3 + c]) block[4 * c] += share;
      });
  }
}

/// The sum of P^T A P over cells, and of the diagonal blocks of A, if wanted. Where several pieces
/// are visited at once, their parts are added in the order of the pieces.
class ProjectedCells final : public TangentPieces {
 public:
  ProjectedCells(const TangentMatrix& a, const Interpolation& p, BlockRows<double>& sum,
                 DiagonalBlocks* diagonal)
      : TangentPieces(slots_for(a.workers())), sum_(sum), diagonal_(diagonal) {
    for (std::size_t slot = 0; slot < slots(); ++slot) {
      Part& part = parts_.emplace_back();
      const auto add = [&, keeps = slots() > 1](std::span<const Index> nodes, double factor,
                                                const double* values) {
        if (keeps)
          part.blocks.keep(nodes, factor, values);
        else
          sum_.add(nodes, factor, values);
      };
      part.projection.emplace(p, a.free(), sum.pattern().rows(), add);
    }
  }

  void visit(std::size_t slot, const CellTangents& cells) override {
    Part& part = parts_[slot];
    part.projection->subtract(cells);
    if (!diagonal_) return;
    for_each_diagonal_block(cells, [&](Index v, const Eigen::Matrix3d& block) {
      if (slots() > 1)
        part.diagonal.emplace_back(v, block);
      else
        (*diagonal_)[v] -= block;
    });
  }

  void end_piece(std::size_t slot) override {
    Part& part = parts_[slot];
    part.projection->finish();
    part.blocks.add_to(sum_);
    for (const auto& [v, block] : part.diagonal) (*diagonal_)[v] -= block;
    part.diagonal.clear();
  }

 private:
  struct Part {
    std::optional<CellProjection> projection;
    KeptBlocks blocks;
    std::vector<std::pair<Index, Eigen::Matrix3d>> diagonal;
  };
  static std::size_t slots_for(const Workers* workers) {
    return workers->threads() > 1 ? 4 * std::size_t{workers->threads()} : 1;
  }

  UpperSum sum_;
  DiagonalBlocks* diagonal_;
  std::deque<Part> parts_;
};

/// One row of A P: its coarse nodes and blocks.
class ProjectedRow {
 public:
  explicit ProjectedRow(Index coarse_nodes) : place_(coarse_nodes, none) {}

  void compute(const BlockRows<double>& a, const Interpolation& p, Index row) {
    for (const Index node : nodes_) place_[node] = none;
    nodes_.clear();
    const BlockPattern& pattern = a.pattern();
    for (const Index j : pattern.row(row))
      for (Index k = p.begin[j]; k < p.begin[j + 1]; ++k)
        if (std::exchange(place_[p.node[k]], 0) == none) nodes_.push_back(p.node[k]);
    std::ranges::sort(nodes_);
    for (std::size_t i = 0; i < nodes_.size(); ++i) place_[nodes_[i]] = static_cast<Index>(i);
    blocks_.assign(nodes_.size() * block_size, 0.0);
    for (Index i = pattern.begin[row]; i < pattern.begin[row + 1]; ++i)
      add(a.block(i), p, pattern.column[i]);
  }
  std::span<const Index> nodes() const { return nodes_; }
  /// The place of the first node from `node` on.
  std::size_t first_from(Index node) const {
    return static_cast<std::size_t>(std::ranges::lower_bound(nodes_, node) - nodes_.begin());
  }
  const double* block(std::size_t i) const { return blocks_.data() + i * block_size; }

 private:
  void add(const double* block, const Interpolation& p, Index column) {
    for (Index k = p.begin[column]; k < p.begin[column + 1]; ++k) {
      double* to = blocks_.data() + place_[p.node[k]] * block_size;
      for (std::size_t c = 0; c < block_size; ++c) to[c] += p.weight[k] * block[c];
    }
  }

  std::vector<Index> place_, nodes_;
  std::vector<double> blocks_;
};

}  // namespace

BlockRows<double> project(const TangentMatrix& a, const Interpolation& p,
                          const BlockPattern& pattern, DiagonalBlocks* diagonal) {
  BlockRows<double> result(pattern);
  if (diagonal) *diagonal = mass_blocks(a);
  ProjectedCells cells(a, p, result, diagonal);
  a.for_each_cell(cells);
  add_masses(a, p, result);
  mirror(result);
  return result;
}

BlockRows<double> project(const BlockRows<double>& a, const Interpolation& p,
                          const BlockPattern& pattern) {
  BlockRows<double> result(pattern);
  ProjectedRow row(pattern.rows());
  for (Index i = 0; i < p.fine_nodes(); ++i) {
    row.compute(a, p, i);
    for (Index k = p.begin[i]; k < p.begin[i + 1]; ++k) {
      const std::size_t first = row.first_from(p.node[k]);
      result.add_row(p.node[k], row.nodes().subspan(first), [&](std::size_t b, double* block) {
        const double* from = row.block(first + b);
        for (std::size_t c = 0; c < block_size; ++c) block[c] += double{p.weight[k]} * from[c];
      });
    }
  }
  mirror(result);
  return result;
}

void hold(BlockRows<double>& a, const Held& held) {
  const BlockPattern& pattern = a.pattern();
  for (Index row = 0; row < pattern.rows(); ++row)
    for (Index i = pattern.begin[row]; i < pattern.begin[row + 1]; ++i)
      for (std::size_t c = 0; c < block_size; ++c)
        if (held[std::size_t{row} * 3 + c % 3] || held[std::size_t{pattern.column[i]} * 3 + c / 3])
          a.block(i)[c] = 0;
}

Interpolation identity(const NodeGraph& graph) {
  Interpolation p;
  std::vector<bool> used(graph.nodes());
  for (const Index node : graph.cell_nodes) used[node] = true;
  for (Index node = 0; node < graph.nodes(); ++node) {
    p.begin.push_back(static_cast<Index>(p.node.size()));
    if (used[node]) p.node.push_back(node);
  }
  p.begin.push_back(static_cast<Index>(p.node.size()));
  p.weight.assign(p.node.size(), 1.0f);
  return p;
}

}  // namespace suture
