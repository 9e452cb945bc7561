// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/multigrid_levels.hpp"

#include <algorithm>

namespace suture {
namespace {

/// Coarsening ends when it removes less than this part of the nodes.
constexpr double least_gain = 0.15;

/// A block may be singular where a coarse node has few fine ones.
constexpr double block_shift = 1e-6;

MultigridLevel finest_level(const NodeGraph& vertices, const std::vector<std::uint8_t>& free) {
  MultigridLevel level;
  level.held.resize(free.size());
  std::ranges::transform(free, level.held.begin(), [](auto is_free) { return !is_free; });
  level.loose = loose_nodes(vertices, level.held);
  return level;
}

/// Takes the interpolation away.
MultigridLevel coarser_level(Coarsening& coarsening, const MultigridLevel& finer) {
  const Index nodes = coarsening.coarse.nodes();
  MultigridLevel level;
  level.held = held_nodes(coarsening.interpolation, nodes, finer.held);
  level.loose = loose_nodes(coarsening.interpolation, nodes, finer.loose);
  level.pattern = pattern_of(coarsening.coarse);
  level.to_finer = std::move(coarsening.interpolation);
  return level;
}

}  // namespace

std::size_t MultigridLevel::bytes() const {
  return to_finer.begin.size() * sizeof(Index) + to_finer.node.size() * 2 * sizeof(Index) +
         (pattern.begin.size() + pattern.column.size()) * sizeof(Index) + matrix.bytes() +
         smoother.bytes() + 3 * x.size() * sizeof(float) + held.size();
}

MultigridLevels make_levels(const NodeGraph& vertices, const std::vector<std::uint8_t>& free,
                            Index coarsest_nodes) {
  MultigridLevels levels;
  levels.push_back(finest_level(vertices, free));
  NodeGraph graph;
  for (const NodeGraph* finer = &vertices; finer->nodes() > coarsest_nodes; finer = &graph) {
    Coarsening next = coarsen(*finer);
    if (next.coarse.nodes() > (1 - least_gain) * finer->nodes()) break;
    levels.push_back(coarser_level(next, levels.back()));
    graph = std::move(next.coarse);
  }
  for (MultigridLevel& level : levels)
    level.x = level.r = level.correction = single_vector(level.nodes());
  return levels;
}

void set_smoother(MultigridLevel& level, DiagonalBlocks diagonal) {
  for (std::size_t v = 0; v < diagonal.size(); ++v) {
    const std::uint8_t* held = &level.held[v * 3];
    invert(diagonal[v], {held[0] == 0, held[1] == 0, held[2] == 0}, block_shift);
  }
  level.smoother.set(diagonal, level.multiply);
}

void VCycle::run(std::size_t l) const {
  if (l + 1 == levels_.size()) return solve_coarsest();
  MultigridLevel& level = levels_[l];
  std::ranges::fill(level.x, 0.0f);
  level.smoother.smooth(level.multiply, smoothing_, level.x, level.r, true);
  restrict(l);
  run(l + 1);
  prolong(l);
  level.smoother.smooth(level.multiply, smoothing_, level.x, level.r, false);
}

void VCycle::solve_coarsest() const {
  MultigridLevel& level = levels_.back();
  std::vector<double> x(level.r.begin(), level.r.end() - 1);
  coarsest_.solve(x);
  std::ranges::transform(x, level.x.begin(), [](double v) { return static_cast<float>(v); });
}

void VCycle::restrict(std::size_t l) const {
  const MultigridLevel& fine = levels_[l];
  MultigridLevel& coarse = levels_[l + 1];
  const Interpolation& p = coarse.to_finer;
  std::ranges::fill(coarse.r, 0.0f);
  for (std::size_t v = 0; v < p.fine_nodes(); ++v)
    for (Index i = p.begin[v]; i < p.begin[v + 1]; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        coarse.r[std::size_t{p.node[i]} * 3 + c] += p.weight[i] * fine.r[v * 3 + c];
  for (std::size_t i = 0; i < coarse.held.size(); ++i)
    if (coarse.held[i]) coarse.r[i] = 0;
}

/// Adds the correction of the next coarser level to x, and updates r.
void VCycle::prolong(std::size_t l) const {
  MultigridLevel& fine = levels_[l];
  const MultigridLevel& coarse = levels_[l + 1];
  const Interpolation& p = coarse.to_finer;
  for (std::size_t v = 0; v < p.fine_nodes(); ++v)
    for (std::size_t c = 0; c < 3; ++c) {
      float sum = 0;
      for (Index i = p.begin[v]; i < p.begin[v + 1]; ++i)
        sum += p.weight[i] * coarse.x[std::size_t{p.node[i]} * 3 + c];
      fine.correction[v * 3 + c] = fine.held[v * 3 + c] ? 0 : sum;
    }
  fine.smoother.correct(fine.multiply, fine.correction, fine.x, fine.r);
}

}  // namespace suture
