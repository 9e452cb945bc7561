// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/solvers/coarsening.hpp"

#include <gtest/gtest.h>

#include "kernel/base/vec3.hpp"
#include "tests/solvers/solver_body.hpp"

namespace suture::test {
namespace {

TEST(Coarsening, ASlitSeparatesCoarseNodes) {
  SolverBody whole(unit_box({4, 2, 8})), cut(unit_box({4, 2, 8}), {.is_cut = slit});
  EXPECT_EQ(coarsen(vertex_graph(whole.complex(), whole.attributes())).coarse.nodes(), 3u * 2 * 5);
  // The slit opens above z = 4: two more nodes at z = 6 and at z = 8, on each of its sides.
  NodeGraph graph = vertex_graph(cut.complex(), cut.attributes());
  EXPECT_EQ(coarsen(graph).coarse.nodes(), 3u * 2 * 5 + 4);
  // Vertices of removed elements have no place: pairs of them would take minutes.
  graph.places.resize(graph.places.size() + 500'000);
  EXPECT_EQ(coarsen(graph).coarse.nodes(), 3u * 2 * 5 + 4);
}

// The coarse nodes nearest to the end of a slit would otherwise hold its sides together.
TEST(Coarsening, ASlitThatEndsBetweenCoarseNodesOpensFromItsEnd) {
  const auto ends_at_3 = [](const Vec3& a, const Vec3& b) {
    return std::min(a[0], b[0]) < 2 && std::max(a[0], b[0]) > 2 && std::min(a[2], b[2]) > 3;
  };
  SolverBody cut(unit_box({4, 2, 8}), {.is_cut = ends_at_3});
  const NodeGraph vertices = vertex_graph(cut.complex(), cut.attributes());
  const Coarsening one = coarsen(vertices);
  // Two nodes more at z = 4, at z = 6 and at z = 8.
  EXPECT_EQ(one.coarse.nodes(), 3u * 2 * 5 + 6);
  const Interpolation& p = one.interpolation;
  const auto is_at = [](const Vec3& place, double x, double z) {
    return place[0] == x && place[2] == z;
  };
  int ends = 0, sides = 0;
  for (Index v = 0; v < vertices.nodes(); ++v) {
    float sum = 0;
    std::vector<float> near_4;  // of the coarse nodes at z = 4, which is 2 there
    for (Index i = p.begin[v]; i < p.begin[v + 1]; ++i) {
      sum += p.weight[i];
      if (is_at(one.coarse.places[p.node[i]], 1, 2)) near_4.push_back(p.weight[i]);
    }
    EXPECT_EQ(sum, 1);
    if (is_at(vertices.places[v], 2, 3) && vertices.places[v][1] == 0) {
      ++ends;
      EXPECT_EQ(near_4, std::vector<float>({0.25f, 0.25f}));
    }
    if (is_at(vertices.places[v], 2, 4) && vertices.places[v][1] == 0) {
      ++sides;
      EXPECT_EQ(near_4, std::vector<float>({1}));
    }
  }
  EXPECT_EQ(ends, 1);
  EXPECT_EQ(sides, 2);
}

/// The least of the largest weights of each coarse node.
float least_part(const Coarsening& coarsening) {
  std::vector<float> largest(coarsening.coarse.nodes());
  const Interpolation& p = coarsening.interpolation;
  for (std::size_t i = 0; i < p.node.size(); ++i)
    largest[p.node[i]] = std::max(largest[p.node[i]], p.weight[i]);
  return std::ranges::min(largest);
}

// With coarse nodes outside the body, nested iteration failed.
TEST(Coarsening, CoarseGridsFitABodyThatIsNoGrid) {
  for (const Index cells : {8u, 9u, 12u, 16u}) {
    SolverBody body(distorted(unit_box({cells, 10, 24}), 0.2), {.held = 0.3});
    const NodeGraph vertices = vertex_graph(body.complex(), body.attributes());
    EXPECT_FALSE(vertices.is_grid);
    const Coarsening one = coarsen(vertices), two = coarsen(one.coarse);
    EXPECT_GT(least_part(one), 0.2) << cells << " cells wide";
    EXPECT_GE(least_part(two), 0.5) << cells << " cells wide";
  }
}

}  // namespace
}  // namespace suture::test
