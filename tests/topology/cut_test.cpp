// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>

#include "kernel/base/error.hpp"
#include "tests/topology/changes.hpp"
#include "tests/topology/meshes.hpp"

namespace suture {
namespace {

using namespace meshes;

TEST(Cut, SeparatesTwoCubes) {
  CellComplex map = complex_of(two_cubes());
  const CellComplex before = map;
  const TopologyChange change = map.cut(std::array<Dart, 1>{8});
  map.validate();
  EXPECT_EQ(change.faces_cut, 1u);
  EXPECT_EQ(change.splits[0].size(), 4u);
  EXPECT_EQ(change.splits[1].size(), 4u);
  EXPECT_EQ(change.splits[2].size(), 1u);
  EXPECT_EQ(map.vertices_of(0), before.vertices_of(0));  // the smallest element keeps its ids
  EXPECT_EQ(map.count(0), 16u);
  EXPECT_EQ(map.count(1), 24u);
  EXPECT_EQ(map.count(2), 12u);
  expect_change_tells_all(before, map, change);
}

TEST(Cut, OneInnerFaceSplitsNothingButTheFace) {
  CellComplex map = complex_of(grid(4, 4, 4));
  const CellComplex before = map;
  const Index e = 1 + 4 * (1 + 4 * 1);  // around its face x1 all vertices are inner ones
  const TopologyChange change = map.cut(std::array<Dart, 1>{24 * e + 8});
  map.validate();
  EXPECT_TRUE(change.splits[0].empty());
  EXPECT_TRUE(change.splits[1].empty());
  EXPECT_EQ(change.splits[2].size(), 1u);
  EXPECT_EQ(change.elements, (std::vector<Index>{e, e + 1}));
  expect_change_tells_all(before, map, change);
}

TEST(Cut, SlitOpensTheEdgesBetweenItsFacesOnly) {
  CellComplex map = complex_of(grid(4, 4, 4));
  const CellComplex before = map;
  const Index e = 1 + 4 * (1 + 4 * 1);
  const TopologyChange change = map.cut(std::array<Dart, 2>{24 * e + 8, 24 * (e + 4) + 8});
  map.validate();
  EXPECT_TRUE(change.splits[0].empty());
  EXPECT_EQ(change.splits[1].size(), 1u);
  expect_change_tells_all(before, map, change);
}

TEST(Cut, RefusesBoundaryFacesAndThenDoesNothing) {
  CellComplex map = complex_of(two_cubes());
  EXPECT_FALSE(map.can_cut(0));
  EXPECT_FALSE(map.can_cut(48));
  EXPECT_TRUE(map.can_cut(8));
  EXPECT_TRUE(map.can_cut(24));
  EXPECT_THROW(map.cut(std::array<Dart, 2>{8, 0}), TopologyError);
  EXPECT_THROW(map.cut(std::array<Dart, 2>{8, 4800}), TopologyError);
  map.validate();
  EXPECT_TRUE(map.can_cut(8));
  EXPECT_EQ(map.count(0), 12u);
}

TEST(Cut, OfNothingIsNoChange) {
  CellComplex map = complex_of(two_cubes());
  const TopologyChange change = map.cut({});
  EXPECT_TRUE(change.empty());
  EXPECT_TRUE(change.elements.empty());
}

TEST(Cut, NeitherOrderNorSideNorRepetitionOfTheRequestMatters) {
  std::mt19937 random(11);
  const Mesh mesh = grid(5, 5, 5);
  CellComplex one = complex_of(mesh), other = complex_of(mesh);
  std::vector<Dart> faces = interior_faces(one);
  std::shuffle(faces.begin(), faces.end(), random);
  faces.resize(faces.size() / 2);
  const TopologyChange first = one.cut(faces);
  std::vector<Dart> again;
  for (const Dart d : faces) {
    again.push_back(d + random() % 4);
    again.push_back(other.beta3(d));
  }
  std::shuffle(again.begin(), again.end(), random);
  const TopologyChange second = other.cut(again);
  EXPECT_EQ(first.faces_cut, second.faces_cut);
  EXPECT_TRUE(std::ranges::equal(one.vertices(), other.vertices()));
  EXPECT_TRUE(std::ranges::equal(one.edges(), other.edges()));
  EXPECT_TRUE(std::ranges::equal(one.faces(), other.faces()));
  EXPECT_EQ(first.elements, second.elements);
}

TEST(Cut, WithoutEdgeAndFaceIdsSplitsTheSameVertices) {
  const Mesh mesh = grid(4, 4, 2);
  CellComplex full = complex_of(mesh);
  CellComplex lean(mesh.hexahedra, Index(mesh.points.size()));
  std::vector<Dart> faces;
  for (Dart d = 20; d < 24 * 16; d += 24) faces.push_back(d);  // z1 of the lower layer
  full.cut(faces);
  const TopologyChange change = lean.cut(faces);
  lean.validate();
  EXPECT_TRUE(std::ranges::equal(full.vertices(), lean.vertices()));
  EXPECT_TRUE(change.splits[1].empty());
  EXPECT_EQ(change.elements.size(), 32u);
  lean.require_edges();
  lean.require_faces();
  lean.validate();
  EXPECT_EQ(lean.count(1), full.count(1));
  EXPECT_EQ(lean.count(2), full.count(2));
}

TEST(Cut, DoesTheSameInRoomThatWasMadeForIt) {
  constexpr Index side = 120;
  CellComplex map = complex_of(grid(side, side, 2)), ready = map;
  std::vector<Dart> faces;
  for (Index e = 0; e < side * side; ++e) faces.push_back(24 * e + 4 * 5);
  ready.make_room(side * side, side * side);
  EXPECT_EQ(ready.count(0), map.count(0));
  for (int repetition = 0; repetition < 2; ++repetition) {  // in the memory of the change before
    CellComplex cut = map, cut_ready = ready;
    const TopologyChange change = cut.cut(faces), in_room = cut_ready.cut(faces);
    cut_ready.validate();
    ASSERT_EQ(change.splits[1].size(), 2 * side * (side + 1));
    for (int d = 0; d < 3; ++d) {
      EXPECT_TRUE(std::ranges::equal(change.stars[d].cells, in_room.stars[d].cells));
      EXPECT_TRUE(std::ranges::equal(change.stars[d].offsets, in_room.stars[d].offsets));
      EXPECT_TRUE(std::ranges::equal(change.stars[d].darts, in_room.stars[d].darts));
      ASSERT_EQ(cut.count(d), cut_ready.count(d));
      for (Index i = 0; i < cut.count(d); ++i)
        ASSERT_EQ(cut.dart_of(d, i), cut_ready.dart_of(d, i));
    }
  }
}

TEST(Cut, IntoSingleElements) {
  CellComplex map = complex_of(grid(3, 4, 5));
  const CellComplex before = map;
  const TopologyChange change = map.cut(interior_faces(map));
  map.validate();
  EXPECT_EQ(map.count(0), 60u * 8);
  EXPECT_EQ(map.count(1), 60u * 12);
  EXPECT_EQ(map.count(2), 60u * 6);
  Index islands = 0;
  map.islands(&islands);
  EXPECT_EQ(islands, 60u);
  expect_change_tells_all(before, map, change);
}

TEST(Cut, SeparatesWheelsOfAnyValence) {
  CellComplex map = complex_of(wheel(3000));
  const CellComplex before = map;
  const std::vector<Dart> faces = interior_faces(map);
  ASSERT_EQ(faces.size(), 3000u);
  // One spoke opens the closed fan without splitting the axis; a second one splits it.
  TopologyChange change = map.cut(std::span(faces).first(1));
  EXPECT_EQ(change.splits[0].size(), 2u);  // the spoke's outer vertices
  change = map.cut(std::span(faces).subspan(1500, 1));
  EXPECT_EQ(change.splits[0].size(), 4u);
  map.validate();
}

/// Both sides of the cut face are connected behind the axis, two steps away: what
/// looks like two regular half stars is one and the same.
TEST(Cut, OfOneOfTwoFacesThatTwoElementsShareLeavesTheAxisWhole) {
  CellComplex map = complex_of(wheel(2));
  const std::vector<Dart> faces = interior_faces(map);
  ASSERT_EQ(faces.size(), 2u);
  const CellComplex before = map;
  const TopologyChange change = map.cut(std::span(faces).first(1));
  map.validate();
  EXPECT_EQ(change.splits[0].size(), 2u);  // the spoke's outer vertices
  EXPECT_EQ(change.splits[1].size(), 3u);  // all edges of the face but the axis
  expect_change_tells_all(before, map, change);
}

TEST(Cut, RandomSequencesKeepTheLaws) {
  const unsigned seed = 20260101;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 30; ++round) {
    CellComplex map = complex_of(blob(5, 0.6, random));
    map.validate();
    for (int step = 0; step < 4; ++step) {
      std::vector<Dart> faces = interior_faces(map);
      std::shuffle(faces.begin(), faces.end(), random);
      faces.resize(faces.size() / 3);
      const CellComplex before = map;
      const TopologyChange change = map.cut(faces);
      map.validate();
      expect_change_tells_all(before, map, change);
    }
  }
}

}  // namespace
}  // namespace suture
