// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/coarse_system.hpp"

#include <gtest/gtest.h>

#include "kernel/base/vec3.hpp"
#include "kernel/solvers/cell_projection.hpp"
#include "kernel/solvers/cell_sample.hpp"
#include "kernel/solvers/multigrid.hpp"
#include "tests/solvers/solver_body.hpp"

namespace suture::test {
namespace {

/// Trilinear interpolation from a grid four times as wide.
Coarsening to_every_fourth(SolverBody& body) {
  NodeGraph graph = vertex_graph(body.complex(), body.attributes());
  for (Vec3& place : graph.places)
    for (double& x : place) x /= 2;
  graph.is_grid = false;
  return coarsen(graph);
}

/// The sum of the diagonals of cell matrices.
double trace(const CellTangents& cells, std::span<const float> weights = {}) {
  double sum = 0;
  const std::size_t rows = std::size_t{cells.nodes} * 3;
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t l = 0; l < cells.cells; ++l)
      sum += (weights.empty() ? 1 : weights[l]) * cells.values[(i * rows + i) * 8 + l];
  return sum;
}

TEST(CellSample, StandsForAllCellsOfEveryFunctor) {
  for (const char* model : {"tm-faure", "mss-baudet"}) {
    SolverBody body(unit_box({12, 12, 24}), {.is_cut = slit, .model = model});
    const Coarsening fourth = to_every_fourth(body);
    const CellSample sample(body.matrix(), fourth.interpolation, fourth.coarse.places);
    double all = 0, sampled = 0;
    std::size_t cells = 0, visited = 0;
    body.matrix().for_each_cell([&](const CellTangents& some) {
      all += trace(some);
      cells += some.cells;
    });
    sample.for_each_cell(body.matrix(), [&](const CellTangents& some, auto weights) {
      sampled += trace(some, weights);
      visited += some.cells;
    });
    EXPECT_NEAR(sampled / all, 1, 0.02) << model;
    EXPECT_LT(visited, cells / 2) << model;
  }
}

/// The stiffness at each coarse node: the traces of the diagonal blocks of the projected operator.
std::vector<double> stiffness(const Coarsening& fourth, SolverBody& body,
                              const CellSample* sample) {
  const BlockPattern pattern = pattern_of(fourth.coarse);
  BlockRows<double> sum(pattern);
  UpperSum upper(sum);
  CellProjection projection(fourth.interpolation, body.matrix().free(), pattern.rows(),
                            [&](std::span<const Index> nodes, double factor, const double* values) {
                              upper.add(nodes, factor, values);
                            });
  const auto subtract = [&](const CellTangents& some, std::span<const float> weights) {
    projection.subtract(some, weights);
  };
  if (sample)
    sample->for_each_cell(body.matrix(), subtract);
  else
    body.matrix().for_each_cell([&](const CellTangents& some) { subtract(some, {}); });
  projection.finish();
  std::vector<double> result;
  for (Index row = 0; row < pattern.rows(); ++row)
    for (Index i = pattern.begin[row]; i < pattern.begin[row + 1]; ++i)
      if (pattern.column[i] == row)
        result.push_back(sum.block(i)[0] + sum.block(i)[4] + sum.block(i)[8]);
  return result;
}

// At the end that is held, a layer of cells moves like none of the others.
TEST(CellSample, IntegratesTheStiffnessOfEveryCoarseNode) {
  SolverBody body(unit_box({12, 12, 24}));
  const Coarsening fourth = to_every_fourth(body);
  const CellSample sample(body.matrix(), fourth.interpolation, fourth.coarse.places);
  const std::vector<double> all = stiffness(fourth, body, nullptr),
                            sampled = stiffness(fourth, body, &sample);
  ASSERT_EQ(all.size(), fourth.coarse.nodes());
  double squares = 0, count = 0;
  for (std::size_t node = 0; node < all.size(); ++node) {
    if (fourth.coarse.places[node][2] < 2) continue;
    squares += std::pow(sampled[node] / all[node] - 1, 2);
    ++count;
  }
  EXPECT_LT(std::sqrt(squares / count), 0.15);
}

// Around the lowest coarse nodes, half of the cells in an octant have no vertex that is free.
TEST(CellSample, MissesNoCoarseNode) {
  SolverBody body(unit_box({6, 6, 24}), {.held = 5});
  const Coarsening fourth = to_every_fourth(body);
  const CellSample sample(body.matrix(), fourth.interpolation, fourth.coarse.places);
  const std::vector<double> all = stiffness(fourth, body, nullptr),
                            sampled = stiffness(fourth, body, &sample);
  ASSERT_EQ(all.size(), fourth.coarse.nodes());
  for (std::size_t node = 0; node < all.size(); ++node)
    EXPECT_GE(sampled[node], 0.2 * all[node]) << node;
  EXPECT_LT(sample.size(), body.complex().existing(3) / 3);
}

/// The relative error, in energy, of the coarse system's answer to the load of a displacement that
/// its level represents.
double coarse_error(SolverBody& body) {
  const auto multigrid = make_multigrid(body.complex(), body.attributes(), {.coarsest_nodes = 40});
  const TangentMatrix& a = body.matrix();
  CoarseSystem system(multigrid->coarse_levels(a), 2, a);
  system.build(a);
  std::vector<double> u(a.size()), load(u), error(u), image(u);
  EXPECT_EQ(system.solve(a, system.restrict(body.weight()), u), LinearSolve::Outcome::converged);
  EXPECT_GT(dot(u, body.weight()), 0);
  a.apply(u.data(), load.data());
  EXPECT_EQ(system.solve(a, system.restrict(load), error), LinearSolve::Outcome::converged);
  for (std::size_t i = 0; i < u.size(); ++i) error[i] -= u[i];
  a.apply(error.data(), image.data());
  return std::sqrt(dot(error, image) / dot(u, load));
}

// In at most 20 iterations, which a bad sample would exceed.
TEST(CoarseSystem, IsSolvedWithAPreconditionerFromASample) {
  SolverBody bar(unit_box({8, 8, 16})), cut(unit_box({8, 8, 16}), {.is_cut = slit}),
      skew(distorted(unit_box({8, 8, 16}), 0.2), {.held = 0.3}),
      springs(unit_box({8, 8, 16}), {.model = "mss-baudet"});
  EXPECT_LT(coarse_error(bar), 0.2);
  EXPECT_LT(coarse_error(cut), 0.2);
  EXPECT_LT(coarse_error(skew), 0.2);
  EXPECT_LT(coarse_error(springs), 0.2);
}

TEST(CoarseSystem, DoesNotDisturbTheMultigrid) {
  SolverBody body(unit_box({8, 8, 16}), {.is_cut = slit});
  const auto multigrid = make_multigrid(body.complex(), body.attributes(), {.coarsest_nodes = 40});
  CoarseSystem system(multigrid->coarse_levels(body.matrix()), 2, body.matrix());
  system.build(body.matrix());
  multigrid->build(body.matrix());
  const auto other = make_multigrid(body.complex(), body.attributes(), {.coarsest_nodes = 40});
  other->build(body.matrix());
  const std::vector<double> load = body.weight();
  std::vector<double> x(load.size()), y(load.size());
  multigrid->apply(load.data(), x.data());
  other->apply(load.data(), y.data());
  EXPECT_EQ(x, y);
}

}  // namespace
}  // namespace suture::test
