// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/multigrid_levels.hpp"

#include <algorithm>

#include "kernel/solvers/clones.hpp"

namespace suture {
namespace {

/// Coarsening ends when it removes less than this part of the nodes.
constexpr double least_gain = 0.15;

/// A block may be singular where a coarse node has few fine ones.
constexpr double block_shift = 1e-6;

DiagonalBlocks diagonal_of(const BlockRows<double>& a) {
  const BlockPattern& pattern = a.pattern();
  DiagonalBlocks blocks(pattern.rows(), Eigen::Matrix3d::Zero());
  for (Index row = 0; row < pattern.rows(); ++row)
    for (Index i = pattern.begin[row]; i < pattern.begin[row + 1]; ++i)
      if (pattern.column[i] == row) blocks[row] = Eigen::Map<const Eigen::Matrix3d>(a.block(i));
  return blocks;
}

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
  level.places = coarsening.coarse.places;
  level.to_finer = std::move(coarsening.interpolation);
  level.from_finer = transposed(level.to_finer, nodes);
  return level;
}

/// The places in rows of 4 of components that are held.
std::vector<Index> places_of(const Held& held) {
  std::vector<Index> places;
  for (std::size_t i = 0; i < held.size(); ++i)
    if (held[i]) places.push_back(static_cast<Index>(i / 3 * 4 + i % 3));
  return places;
}

SUTURE_CLONES
void multiply(const Index* begin, const Index* node, const float* weight, const SingleRow* from,
              SingleRow* to, std::size_t rows) {
  for (std::size_t v = 0; v < rows; ++v) {
    SingleRow sum{};
    for (Index i = begin[v]; i < begin[v + 1]; ++i) sum += weight[i] * from[node[i]];
    to[v] = sum;
  }
}

/// to = P from.
void multiply(const Interpolation& p, const float* from, float* to, const Workers* workers) {
  for_vector_chunks(p.begin.size() - 1, workers, [&](std::size_t first, std::size_t rows) {
    multiply(&p.begin[first], p.node.data(), p.weight.data(),
             reinterpret_cast<const SingleRow*>(from), reinterpret_cast<SingleRow*>(to) + first,
             rows);
  });
}

std::size_t bytes_of(const Interpolation& p) {
  return (p.begin.size() + 2 * p.node.size()) * sizeof(Index);
}

}  // namespace

std::size_t MultigridLevel::bytes() const {
  return bytes_of(to_finer) + bytes_of(from_finer) +
         (pattern.begin.size() + pattern.column.size()) * sizeof(Index) + matrix.bytes() +
         smoother.bytes() + 3 * x.size() * sizeof(float) + held.size() +
         held_places.size() * sizeof(Index) + places.size() * sizeof(Vec3);
}

MultigridLevels make_levels(const NodeGraph& vertices, const std::vector<std::uint8_t>& free,
                            Index coarsest_nodes, const Workers* workers) {
  MultigridLevels levels;
  levels.push_back(finest_level(vertices, free));
  NodeGraph graph;
  for (const NodeGraph* finer = &vertices; finer->nodes() > coarsest_nodes; finer = &graph) {
    Coarsening next = coarsen(*finer);
    if (next.coarse.nodes() > (1 - least_gain) * finer->nodes()) break;
    levels.push_back(coarser_level(next, levels.back()));
    graph = std::move(next.coarse);
  }
  for (MultigridLevel& level : levels) {
    level.workers = workers;
    level.held_places = places_of(level.held);
    level.x = level.r = level.correction = single_vector(level.nodes());
  }
  return levels;
}

void interpolate(const MultigridLevel& level, const float* coarse, float* fine) {
  multiply(level.to_finer, coarse, fine, level.workers);
}

void restrict(const MultigridLevel& level, const float* fine, float* coarse) {
  multiply(level.from_finer, fine, coarse, level.workers);
}

void hold(const MultigridLevel& level, float* v) {
  for (const Index place : level.held_places) v[place] = 0;
}

void set_smoother(MultigridLevel& level, DiagonalBlocks diagonal) {
  for_vector_chunks(diagonal.size(), level.workers, [&](std::size_t first, std::size_t rows) {
    for (std::size_t v = first; v < first + rows; ++v) {
      const std::uint8_t* held = &level.held[v * 3];
      invert(diagonal[v], {held[0] == 0, held[1] == 0, held[2] == 0}, block_shift);
    }
  });
  level.smoother.set(diagonal, level.multiply, level.workers);
}

void set_operator(MultigridLevel& level, const BlockRows<double>& rows) {
  level.matrix = in_single(rows, level.workers);
  level.multiply = [&level](const float* x, float* y) {
    multiply(level.matrix, x, y, level.workers);
  };
  set_smoother(level, diagonal_of(rows));
}

void VCycle::run(std::size_t l) const {
  if (l + 1 == levels_.size()) return solve_coarsest();
  MultigridLevel& level = levels_[l];
  level.smoother.smooth(level.multiply, smoothing_, level.x, level.r);
  restrict(l);
  run(l + 1);
  prolong(l);
  level.smoother.correct(level.multiply, smoothing_, level.correction, level.x, level.r);
}

void VCycle::solve_coarsest() const {
  MultigridLevel& level = levels_.back();
  std::vector<double> x(level.held.size());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = level.r[i / 3 * 4 + i % 3];
  coarsest_.solve(x);
  for (std::size_t i = 0; i < x.size(); ++i) level.x[i / 3 * 4 + i % 3] = static_cast<float>(x[i]);
}

void VCycle::restrict(std::size_t l) const {
  MultigridLevel &fine = levels_[l], &coarse = levels_[l + 1];
  hold(fine, fine.r.data());
  suture::restrict(coarse, fine.r.data(), coarse.r.data());
  hold(coarse, coarse.r.data());
}

/// The correction by the next coarser level.
void VCycle::prolong(std::size_t l) const {
  MultigridLevel& fine = levels_[l];
  const MultigridLevel& coarse = levels_[l + 1];
  interpolate(coarse, coarse.x.data(), fine.correction.data());
  hold(fine, fine.correction.data());
}

}  // namespace suture
