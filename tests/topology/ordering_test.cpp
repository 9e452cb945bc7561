// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/ordering.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/topology/meshes.hpp"

namespace suture {
namespace {

using namespace meshes;

/// The walk through the curve's order stays among near elements, and visits each element once.
TEST(Ordering, TheCurveVisitsEachElementOnceAndStaysNear) {
  std::mt19937 random(5);
  const Mesh mesh = shuffled(grid(20, 20, 20), random);
  const std::vector<bool> used(mesh.points.size(), true);
  EXPECT_FALSE(is_local(mesh.hexahedra, Index(mesh.points.size())));
  const std::vector<Index> order = curve_order(mesh.hexahedra, mesh.points, used);
  std::vector<Hexahedron> along;
  std::vector<Index> visited = order;
  for (const Index e : order) along.push_back(mesh.hexahedra[e]);
  EXPECT_TRUE(is_local(along, Index(mesh.points.size())));
  std::ranges::sort(visited);
  for (Index e = 0; e < visited.size(); ++e) ASSERT_EQ(visited[e], e);
  EXPECT_EQ(local_order(mesh.hexahedra, mesh.points, used), order);
  EXPECT_TRUE(local_order(along, mesh.points, used).empty()) << "a local order is kept";
}

}  // namespace
}  // namespace suture
