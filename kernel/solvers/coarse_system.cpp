// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/coarse_system.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/solvers/cell_projection.hpp"
#include "kernel/solvers/galerkin.hpp"
#include "kernel/solvers/level_solve.hpp"

namespace suture {
namespace {

constexpr unsigned smoothing = 2, max_iterations = 20;
constexpr double tolerance = 0.1;

/// P = P1 P2 for the interpolations P1 and P2 to a level and from the next coarser one to it.
Interpolation product(const Interpolation& finer, const Interpolation& coarser) {
  Interpolation result;
  result.begin.push_back(0);
  for (Index v = 0; v < finer.fine_nodes(); ++v) {
    const std::size_t first = result.node.size();
    for (Index i = finer.begin[v]; i < finer.begin[v + 1]; ++i)
      for (Index k = coarser.begin[finer.node[i]]; k < coarser.begin[finer.node[i] + 1]; ++k) {
        std::size_t place = first;
        while (place < result.node.size() && result.node[place] != coarser.node[k]) ++place;
        if (place == result.node.size()) {
          result.node.push_back(coarser.node[k]);
          result.weight.push_back(0);
        }
        result.weight[place] += finer.weight[i] * coarser.weight[k];
      }
    result.begin.push_back(static_cast<Index>(result.node.size()));
  }
  return result;
}

Interpolation to_vertices(const MultigridLevels& levels, std::size_t level) {
  Interpolation p = levels[1].to_finer;
  for (std::size_t l = 2; l <= level; ++l) p = product(p, levels[l].to_finer);
  return p;
}

}  // namespace

CoarseSystem::CoarseSystem(const CoarseLevels& coarse, std::size_t level, const TangentMatrix& a)
    : levels_(*coarse.levels),
      coarsest_(*coarse.coarsest),
      level_(level),
      p_(to_vertices(levels_, level)),
      sample_(a, p_, levels_[level].places),
      image_(single_vector(levels_[0].nodes())) {
  for (std::size_t l = 0; l < level; ++l) scratch_.push_back(single_vector(levels_[l].nodes()));
}

void CoarseSystem::build(const TangentMatrix& a) {
  BlockRows<double> rows(levels_[level_].pattern);
  UpperSum sum(rows);
  CellProjection projection(p_, a.free(), static_cast<Index>(nodes()),
                            [&](std::span<const Index> nodes, double factor, const double* values) {
                              sum.add(nodes, factor, values);
                            });
  sample_.for_each_cell(a, [&](const CellTangents& cells, std::span<const float> weights) {
    projection.subtract(cells, weights);
  });
  projection.finish();
  mirror(rows);
  hold(rows, levels_[level_].held);
  for (std::size_t l = level_; l + 1 < levels_.size(); ++l) {
    set_operator(levels_[l], rows);
    rows = project(rows, levels_[l + 1].to_finer, levels_[l + 1].pattern);
    hold(rows, levels_[l + 1].held);
  }
  coarsest_.factor(rows, levels_.back().held, levels_.back().loose);
}

std::vector<double> CoarseSystem::restrict(std::span<const double> r) const {
  const Held& held = levels_[level_].held;
  std::vector<double> result(held.size());
  for (std::size_t v = 0; v < p_.fine_nodes(); ++v)
    for (Index i = p_.begin[v]; i < p_.begin[v + 1]; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        result[std::size_t{p_.node[i]} * 3 + c] += double{p_.weight[i]} * r[v * 3 + c];
  for (std::size_t i = 0; i < held.size(); ++i)
    if (held[i]) result[i] = 0;
  return result;
}

/// The displacements of the vertices, scratch_[0].
void CoarseSystem::prolong(const float* q) const {
  for (std::size_t l = level_; l > 0; --l) {
    interpolate(levels_[l], q, scratch_[l - 1].data());
    q = scratch_[l - 1].data();
  }
  hold(levels_[0], scratch_[0].data());
}

/// P^T image_.
void CoarseSystem::restrict_image(float* result) const {
  const float* fine = image_.data();
  for (std::size_t l = 1; l <= level_; ++l) {
    float* const coarse = l == level_ ? result : scratch_[l].data();
    suture::restrict(levels_[l], fine, coarse);
    fine = coarse;
  }
  hold(levels_[level_], result);
}

LinearSolve::Outcome CoarseSystem::solve(const TangentMatrix& a, std::span<const double> right,
                                         std::span<double> d) const {
  SingleVector r = single_vector(nodes()), q;
  const Workers* const workers = levels_[level_].workers;
  const double scale = to_single(right.data(), r, workers);
  const auto multiply = [&](const float* x, float* y) {
    prolong(x);
    a.apply(scratch_[0].data(), image_.data());
    restrict_image(y);
  };
  const auto outcome = solve_on_level(levels_, VCycle(levels_, coarsest_, smoothing), level_,
                                      multiply, std::move(r), tolerance, max_iterations, q);
  prolong(q.data());
  to_double(scratch_[0], scale, d.data(), workers);
  return outcome;
}

}  // namespace suture
