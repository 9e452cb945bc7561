// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/contact/missed_approach.hpp"

#include <gtest/gtest.h>

#include "kernel/contact/boundary_surface.hpp"
#include "kernel/mesh/box.hpp"
#include "tests/topology/operations.hpp"

namespace suture {
namespace {

TEST(MissedApproach, IsFoundAtTheDistanceAtWhichItMayHappen) {
  const Mesh mesh = make_box({.size = {20, 20, 1}, .cells = {20, 20, 1}});
  const CellComplex complex(mesh.hexahedra, static_cast<Index>(mesh.points.size()));
  const BoundarySurface surface(complex);
  std::vector<double> from(4 * mesh.points.size());
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    for (std::size_t c = 0; c < 3; ++c) from[4 * v + c] = mesh.points[v][c];
  const auto missed = [&](const Vec3& all, double bend) {
    std::vector<double> to = from;
    for (std::size_t i = 0; i < to.size(); ++i)
      if (i % 4 < 3) to[i] += all[i % 4] + (i % 4 == 2 ? bend * from[i - 2] : 0);
    return find_missed_approach(surface.vertices(), from.data(), to.data(), 1, 0.3);
  };
  EXPECT_FALSE(missed({7, 8, 9}, 0)) << "everything moves by the same way";
  EXPECT_FALSE(missed({}, 0.1)) << "2 edges over 20 edges";
  const auto found = missed({7, 8, 9}, 0.2);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->distance, 4);
  EXPECT_EQ(found->allowed, 1.3);
  EXPECT_GT(found->way, 1.3);
  for (std::size_t v = 0; v < mesh.points.size(); ++v)  // one end jumps onto the other
    if (mesh.points[v][0] > 18) from[4 * v] += 100;
  const auto jump = [&] {
    std::vector<double> to = from;
    for (std::size_t v = 0; v < mesh.points.size(); ++v)
      if (mesh.points[v][0] > 18) to[4 * v] -= 90;
    return find_missed_approach(surface.vertices(), from.data(), to.data(), 1, 0.3);
  }();
  ASSERT_TRUE(jump);
  EXPECT_EQ(jump->distance, 64) << "the first size whose cubes touch across the gap";
}

}  // namespace
}  // namespace suture
