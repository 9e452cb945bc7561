// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/mesh/voxels.hpp"

#include <gtest/gtest.h>

#include <set>

#include "kernel/base/error.hpp"
#include "kernel/mesh/box.hpp"

namespace suture {
namespace {

// A full drawing is a box: the same points and the same elements, whatever their numbers.
TEST(Voxels, FullDrawingIsABox) {
  const Mesh drawn = make_voxels({{1, 2, 3}, 0.5, 2, {"###", "###"}});
  const Mesh box = make_box({{1, 2, 3}, {1.5, 1, 1}, {3, 2, 2}, {1, 1, 1}});
  ASSERT_EQ(drawn.hexahedra.size(), box.hexahedra.size());
  ASSERT_EQ(drawn.points.size(), box.points.size());
  for (std::size_t e = 0; e < box.hexahedra.size(); ++e) {
    for (std::size_t n = 0; n < 8; ++n) {
      EXPECT_EQ(drawn.points[drawn.hexahedra[e][n]], box.points[box.hexahedra[e][n]])
          << "element " << e << " node " << n;
    }
  }
  for (const auto& [name, points] : box.point_sets) {
    EXPECT_EQ(drawn.point_sets.at(name).size(), points.size()) << name;
  }
}

TEST(Voxels, TheFirstRowIsOnTopAndCharactersNameSets) {
  const Mesh mesh = make_voxels({{0, 0, 0}, 1, 1, {"A", "#B"}});
  ASSERT_EQ(mesh.hexahedra.size(), 3u);
  ASSERT_EQ(mesh.element_sets.size(), 2u);  // '#' has none
  const Index a = mesh.element_sets.at("A").at(0);
  EXPECT_EQ(mesh.points[mesh.hexahedra[a][0]], (Vec3{0, 1, 0}));
  const Index b = mesh.element_sets.at("B").at(0);
  EXPECT_EQ(mesh.points[mesh.hexahedra[b][0]], (Vec3{1, 0, 0}));
  const std::set<Index> nodes(mesh.hexahedra[a].begin(), mesh.hexahedra[a].end());
  EXPECT_EQ(std::vector<Index>(nodes.begin(), nodes.end()), mesh.point_sets.at("A"));
  EXPECT_EQ(mesh.points.size(), 16u);  // 3 cubes in an L share 8 of 24 corners
}

TEST(Voxels, RefusesEmptyDrawings) {
  EXPECT_THROW(make_voxels({{0, 0, 0}, 1, 1, {}}), InputError);
  EXPECT_THROW(make_voxels({{0, 0, 0}, 1, 1, {". .", ""}}), InputError);
  EXPECT_THROW(make_voxels({{0, 0, 0}, 1, 0, {"#"}}), InputError);
  EXPECT_THROW(make_voxels({{0, 0, 0}, 0, 1, {"#"}}), InputError);
}

}  // namespace
}  // namespace suture
