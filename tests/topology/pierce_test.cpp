// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "kernel/base/error.hpp"
#include "tests/topology/changes.hpp"
#include "tests/topology/meshes.hpp"

namespace suture {
namespace {

using namespace meshes;
using Elements = std::vector<Index>;

TEST(Pierce, OneOfTwoCubes) {
  CellComplex map = complex_of(two_cubes());
  const CellComplex before = map;
  const TopologyChange change = map.pierce(Elements{0});
  map.validate();
  EXPECT_EQ(change.removed[3], Elements{0});
  EXPECT_EQ(change.removed[0].size(), 4u);
  EXPECT_EQ(change.removed[1].size(), 8u);
  EXPECT_EQ(change.removed[2].size(), 5u);
  EXPECT_EQ(change.faces_cut, 1u);
  EXPECT_EQ(change.stars[0].size(), 4u);
  EXPECT_EQ(change.stars[1].size(), 4u);
  EXPECT_EQ(change.stars[2].size(), 1u);
  EXPECT_EQ(change.elements, Elements{1});
  EXPECT_EQ(map.vertices_of(1), before.vertices_of(1));  // numbers stay
  EXPECT_EQ(map.dart_of(2, map.faces_of(1)[0]), 24u);
  for (const Index v : map.vertices_of(0)) EXPECT_EQ(v, none);
  EXPECT_EQ(map.islands(), (Elements{none, 0}));
  expect_change_tells_all(before, map, change);
}

TEST(Pierce, TheMiddleOfARowAndOfACross) {
  CellComplex row = complex_of(grid(3, 1, 1));
  CellComplex before = row;
  expect_change_tells_all(before, row, row.pierce(Elements{1}));
  row.validate();
  EXPECT_EQ(row.islands(), (Elements{0, none, 1}));
  EXPECT_EQ(row.existing(0), 16u);

  // Two cubes that touch along an edge are connected around it through a third one.
  CellComplex corner = complex_of(voxels(2, 2, 1, [](int x, int y, int) { return x + y < 2; }));
  before = corner;
  const TopologyChange change = corner.pierce(Elements{0});
  corner.validate();
  EXPECT_EQ(change.splits[0].size(), 2u);
  EXPECT_EQ(change.splits[1].size(), 1u);
  EXPECT_EQ(change.splits[1][0].old_cell, before.edges_of(1)[10]);  // the smaller keeps it
  EXPECT_EQ(corner.edges_of(1)[10], before.edges_of(1)[10]);
  expect_change_tells_all(before, corner, change);
}

TEST(Pierce, ACavityInsideABlock) {
  CellComplex map = complex_of(grid(4, 4, 4));
  const CellComplex before = map;
  Elements inner;
  for (Index z = 1; z < 3; ++z)
    for (Index y = 1; y < 3; ++y)
      for (Index x = 1; x < 3; ++x) inner.push_back(x + 4 * (y + 4 * z));
  std::ranges::reverse(inner);
  inner.push_back(inner[3]);  // neither order nor repetition matters
  const TopologyChange change = map.pierce(inner);
  map.validate();
  EXPECT_EQ(change.removed[0].size(), 1u);
  EXPECT_EQ(change.removed[1].size(), 6u);
  EXPECT_EQ(change.removed[2].size(), 12u);
  EXPECT_EQ(change.removed[3].size(), 8u);
  EXPECT_EQ(change.faces_cut, 24u);
  EXPECT_TRUE(change.splits[0].empty());
  EXPECT_EQ(change.elements.size(), 56u);
  expect_change_tells_all(before, map, change);
}

TEST(Pierce, RefusesWhatIsNotThereAndTheLastOneAndThenDoesNothing) {
  CellComplex map = complex_of(two_cubes());
  const CellComplex before = map;
  EXPECT_TRUE(map.can_pierce(0));
  EXPECT_FALSE(map.can_pierce(2));
  EXPECT_THROW(map.pierce(Elements{0, 2}), TopologyError);
  EXPECT_THROW(map.pierce(Elements{0, 1}), TopologyError);
  expect_change_tells_all(before, map, {});
  map.pierce(Elements{1});
  EXPECT_FALSE(map.can_pierce(0));
  EXPECT_FALSE(map.can_pierce(1));
  EXPECT_FALSE(map.can_cut(24));
  EXPECT_THROW(map.pierce(Elements{1}), TopologyError);
  EXPECT_THROW(map.cut(std::array<Dart, 1>{24}), TopologyError);
  EXPECT_TRUE(map.pierce({}).empty());
  map.validate();
}

TEST(Pierce, WithoutEdgeAndFaceIdsTheyAreBuiltWithoutTheHoles) {
  const Mesh mesh = grid(3, 3, 2);
  CellComplex full = complex_of(mesh);
  CellComplex lean(mesh.hexahedra, Index(mesh.points.size()));
  const Elements some{4, 5, 13};
  full.pierce(some);
  const TopologyChange change = lean.pierce(some);
  EXPECT_TRUE(change.stars[2].cells.empty());
  lean.require_edges();
  lean.require_faces();
  lean.validate();
  EXPECT_TRUE(std::ranges::equal(full.vertices(), lean.vertices()));
  EXPECT_EQ(full.existing(1), lean.count(1));
  EXPECT_EQ(full.existing(2), lean.count(2));
}

TEST(Pierce, RandomSequencesWithCutsKeepTheLaws) {
  const unsigned seed = 20260102;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 40; ++round) {
    CellComplex map = complex_of(blob(5, 0.7, random));
    for (int step = 0; step < 6; ++step) {
      const CellComplex before = map;
      TopologyChange change;
      if (random() % 3 == 0) {
        std::vector<Dart> faces = interior_faces(map);
        std::shuffle(faces.begin(), faces.end(), random);
        faces.resize(faces.size() / 4);
        change = map.cut(faces);
      } else {
        Elements elements;
        for (Index e = 0; e < map.element_count(); ++e)
          if (map.can_pierce(e) && random() % 6 == 0) elements.push_back(e);
        std::shuffle(elements.begin(), elements.end(), random);
        if (elements.size() == map.existing(3)) elements.pop_back();
        change = map.pierce(elements);
      }
      map.validate();
      expect_change_tells_all(before, map, change);
    }
  }
}

}  // namespace
}  // namespace suture
