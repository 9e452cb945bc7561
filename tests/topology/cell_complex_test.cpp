// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/cell_complex.hpp"

#include <gtest/gtest.h>

#include "kernel/base/error.hpp"
#include "tests/topology/meshes.hpp"

namespace suture {
namespace {

using namespace meshes;

TEST(CellComplex, CountsTheCellsOfAGrid) {
  const int nx = 3, ny = 4, nz = 5;
  const CellComplex map = complex_of(grid(nx, ny, nz));
  map.validate();
  EXPECT_EQ(map.count(0), Index((nx + 1) * (ny + 1) * (nz + 1)));
  EXPECT_EQ(map.count(1),
            Index(nx * (ny + 1) * (nz + 1) + (nx + 1) * ny * (nz + 1) + (nx + 1) * (ny + 1) * nz));
  EXPECT_EQ(map.count(2), Index(nx * ny * (nz + 1) + nx * (ny + 1) * nz + (nx + 1) * ny * nz));
  EXPECT_EQ(map.count(3), Index(nx * ny * nz));
}

TEST(CellComplex, Beta3JoinsTheDartsOfTheCommonFaceInOppositeSense) {
  const CellComplex map = complex_of(two_cubes());
  int joined = 0;
  for (Dart d = 0; d < 48; ++d) {
    const Dart mate = map.beta3(d);
    if (mate == none) continue;
    ++joined;
    EXPECT_EQ(map.origin(mate), map.origin(CellComplex::beta1(d)));
    EXPECT_EQ(map.origin(CellComplex::beta1(mate)), map.origin(d));
    EXPECT_EQ(map.edge(mate), map.edge(d));
    EXPECT_EQ(map.face(mate), map.face(d));
  }
  EXPECT_EQ(joined, 8);
  EXPECT_EQ(map.neighbour(0, 2), 1u);  // x1 of the first is x0 of the second
  EXPECT_EQ(map.neighbour(1, 0), 0u);
  EXPECT_EQ(map.neighbour(0, 0), none);
}

TEST(CellComplex, KnowsWhetherItHasOperated) {
  CellComplex map = complex_of(grid(3, 3, 3));
  EXPECT_FALSE(map.has_operated());
  const std::vector<Dart> outside = {24 * 13 + 8, 0};
  EXPECT_THROW(map.cut(outside), TopologyError);
  EXPECT_FALSE(map.has_operated());
  const std::vector<Dart> face = {24 * 13 + 8};  // inside: no vertex changes
  ASSERT_TRUE(map.cut(face).splits[0].empty());
  EXPECT_TRUE(map.has_operated());
  map.validate();
}

TEST(CellComplex, StarsHoldTheLowestDartOfEachIncidentElement) {
  const CellComplex map = complex_of(grid(2, 2, 2));
  std::vector<Dart> star;
  map.star(0, map.vertices_of(0)[7], star);
  ASSERT_EQ(star.size(), 8u);
  for (Index e = 0; e < 8; ++e) {
    EXPECT_EQ(star[e] / 24, e);
    EXPECT_EQ(map.origin(star[e]), map.vertices_of(0)[7]);
    for (Dart lower = 24 * e; lower < star[e]; ++lower)
      EXPECT_NE(map.origin(lower), map.vertices_of(0)[7]);
  }
  map.star(1, map.edges_of(0)[3], star);  // along x at y = z = 1
  EXPECT_EQ(star.size(), 4u);
  map.star(2, map.faces_of(0)[2], star);
  EXPECT_EQ(star, (std::vector<Dart>{8, 24}));
  map.star(3, 5, star);
  EXPECT_EQ(star, std::vector<Dart>{24 * 5});
}

TEST(CellComplex, DartsAreThePapersArray) {
  const auto darts = CellComplex::darts(3);
  for (Dart f = 0; f < 6; ++f)
    for (Dart k = 0; k < 4; ++k) EXPECT_EQ(darts[f][k], 72 + 4 * f + k);
}

TEST(CellComplex, HasNoBoundOnTheValence) {
  const int n = 5000;
  const CellComplex map = complex_of(wheel(n));
  map.validate();
  std::vector<Dart> star;
  map.star(0, map.vertices_of(0)[0], star);
  EXPECT_EQ(star.size(), std::size_t(n));
  map.star(1, map.edge(map.dart_of(0, map.vertices_of(0)[0])), star);
  EXPECT_EQ(map.count(0), Index(4 * n + 2));
}

TEST(CellComplex, SplitsNonManifoldVerticesByOrbit) {
  // Two cubes that touch at one vertex, and two that touch along one edge.
  std::vector<Split> split;
  Mesh corner = voxels(2, 2, 2, [](int x, int y, int z) { return x == y && y == z; });
  const CellComplex one(corner.hexahedra, Index(corner.points.size()), &split);
  one.validate();
  ASSERT_EQ(split.size(), 1u);
  EXPECT_EQ(split[0].old_cell, one.vertices_of(0)[7]);
  EXPECT_EQ(split[0].new_cell, 15u);
  EXPECT_EQ(one.vertices_of(1)[0], 15u);
  EXPECT_EQ(one.count(0), 16u);

  split.clear();
  const Mesh edge = voxels(2, 2, 1, [](int x, int y, int) { return x == y; });
  const CellComplex two(edge.hexahedra, Index(edge.points.size()), &split);
  EXPECT_EQ(split.size(), 2u);
  EXPECT_EQ(two.count(0), 16u);
}

TEST(CellComplex, SeparatesEdgesThatShareBothVertices) {
  // A ring that closes along an edge: its ends touch along one edge, whose vertices
  // stay whole because the elements around them are connected the other way.
  const Mesh mesh = voxels(3, 3, 3, [](int x, int y, int z) {
    if (z != 1) return true;                          // two plates ...
    return (x == 0 && y == 0) || (x == 1 && y == 1);  // ... and two columns, touching along an edge
  });
  CellComplex map = complex_of(mesh);
  map.validate();
  EXPECT_EQ(map.count(0), Index(mesh.points.size()));
  // Euler characteristic of the union as cells counts that edge once too little.
  std::map<std::pair<Index, Index>, std::vector<Index>> between;
  for (Index id = 0; id < map.count(1); ++id) {
    const Dart d = map.dart_of(1, id);
    between[std::minmax(map.origin(d), map.origin(CellComplex::beta1(d)))].push_back(id);
  }
  EXPECT_EQ(std::ranges::count_if(between, [](const auto& b) { return b.second.size() == 2; }), 1);
}

TEST(CellComplex, NumbersIslandsBySmallestElement) {
  const CellComplex map = complex_of(voxels(5, 1, 1, [](int x, int, int) { return x != 1; }));
  Index count = 0;
  EXPECT_EQ(map.islands(&count), (std::vector<Index>{0, 1, 1, 1}));
  EXPECT_EQ(count, 2u);
}

TEST(CellComplex, RefusesWhatIsNoMapAndNamesAllElements) {
  const auto refuses = [](const Mesh& mesh, std::initializer_list<const char*> words) {
    try {
      CellComplex map(mesh.hexahedra, Index(mesh.points.size()));
      ADD_FAILURE() << "accepted";
    } catch (const TopologyError& error) {
      for (const char* word : words)
        EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  Mesh mesh = two_cubes();
  mesh.hexahedra.push_back(mesh.hexahedra[1]);
  for (int i : {1, 3, 5, 7}) {  // a third element on the common face
    mesh.hexahedra[2][i] = Index(mesh.points.size());
    mesh.points.push_back({2, 0, 0});
  }
  refuses(mesh, {"three elements", "elements 0, 1 and 2"});

  mesh = two_cubes();
  std::swap(mesh.hexahedra[1][0], mesh.hexahedra[1][2]);  // 0 2 4 6 are the common face
  refuses(mesh, {"a different cyclic order", "elements 0 and 1"});

  mesh = two_cubes();
  std::swap(mesh.hexahedra[1][0], mesh.hexahedra[1][2]);
  std::swap(mesh.hexahedra[1][4], mesh.hexahedra[1][6]);
  refuses(mesh, {"same side", "elements 0 and 1"});

  mesh = two_cubes();
  mesh.hexahedra[1][7] = mesh.hexahedra[1][0];
  mesh.hexahedra[0][3] = 12;
  refuses(mesh, {"1 element with a point that does not exist", "element 0 uses point 12",
                 "1 element with the same point twice", "element 1"});
}

}  // namespace
}  // namespace suture
