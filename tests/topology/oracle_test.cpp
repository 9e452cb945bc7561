// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "tests/topology/cgal_map.hpp"
#include "tests/topology/meshes.hpp"

namespace suture {
namespace {

using namespace meshes;

/// For every dart the smallest dart of its cell (dimension 0..3) or island (4); `none` for removed
/// ones.
std::vector<Dart> orbits(const CellComplex& map, int dimension) {
  const Dart darts = 24 * map.element_count();
  const std::vector<Index> island = map.islands();
  const auto id = [&](Dart d) { return dimension == 4 ? island[d / 24] : map.cell(dimension, d); };
  std::map<Index, Dart> first;
  std::vector<Dart> result(darts, none);
  for (Dart d = 0; d < darts; ++d)
    if (map.exists(3, d / 24)) result[d] = first.try_emplace(id(d), d).first->second;
  return result;
}

void expect_same(const CellComplex& map, const CgalMap& oracle) {
  map.validate();
  EXPECT_TRUE(oracle.is_valid());
  for (int dimension = 0; dimension <= 4; ++dimension)
    ASSERT_EQ(orbits(map, dimension), oracle.orbits(dimension)) << "dimension " << dimension;
}

/// Cuts at random until nothing holds together or `steps` are done.
void cut_both(const Mesh& mesh, int steps, std::mt19937& random) {
  CellComplex map = complex_of(mesh);
  CgalMap oracle(mesh);
  ASSERT_NO_FATAL_FAILURE(expect_same(map, oracle));
  for (int step = 0; step < steps; ++step) {
    std::vector<Dart> faces = interior_faces(map);
    if (faces.empty()) return;
    std::shuffle(faces.begin(), faces.end(), random);
    faces.resize(1 + random() % std::max<std::size_t>(1, faces.size() / 3));
    for (Dart& d : faces) d = random() % 2 ? d + random() % 4 : map.beta3(d);
    map.cut(faces);
    oracle.cut(faces);
    ASSERT_NO_FATAL_FAILURE(expect_same(map, oracle)) << "step " << step;
  }
}

class Oracle : public ::testing::Test {
 protected:
  void SetUp() override { std::cout << "seed " << seed << '\n'; }
  const unsigned seed = [] {
    const char* given = std::getenv("SUTURE_SEED");
    return given ? static_cast<unsigned>(std::atoi(given)) : 2026u;
  }();
  const int rounds = std::getenv("SUTURE_FULL") ? 400 : 12;  // of each random kind
  std::mt19937 random{seed};
};

TEST_F(Oracle, NamedMeshes) {
  cut_both(two_cubes(), 2, random);
  cut_both(ring_of_eight(), 4, random);  // genus 1
  cut_both(grid(4, 3, 2), 4, random);
  cut_both(wheel(40), 4, random);
}

TEST_F(Oracle, PlanesThroughAGrid) {
  const Mesh mesh = grid(6, 5, 4);
  CellComplex map = complex_of(mesh);
  CgalMap oracle(mesh);
  for (const int axis : {2, 0, 1}) {  // crossing cuts: vertices split into eight at last
    std::vector<Dart> faces;
    for (const Dart d : interior_faces(map))
      if (std::ranges::all_of(std::array<Dart, 4>{0, 1, 2, 3}, [&](Dart k) {
            const Dart dart = (d & ~3u) + k;
            const Index corner = mesh.hexahedra[d / 24][hexahedron::dart_vertex[dart % 24]];
            return mesh.points[corner][axis] == 2.0;
          }))
        faces.push_back(d);
    ASSERT_FALSE(faces.empty());
    map.cut(faces);
    oracle.cut(faces);
    ASSERT_NO_FATAL_FAILURE(expect_same(map, oracle));
  }
}

TEST_F(Oracle, BlobsWithHolesTunnelsAndNonManifoldCells) {
  for (int round = 0; round < rounds; ++round)
    ASSERT_NO_FATAL_FAILURE(cut_both(blob(5, 0.35 + 0.05 * (round % 11), random), 5, random))
        << "seed " << seed << ", round " << round;
}

TEST_F(Oracle, ShuffledBlobs) {
  for (int round = 0; round < rounds; ++round)
    ASSERT_NO_FATAL_FAILURE(cut_both(shuffled(blob(5, 0.6, random), random), 5, random))
        << "seed " << seed << ", round " << round;
}

TEST_F(Oracle, FramesOfHighGenus) {
  // The edges of a lattice of 2 x 2 x 2 boxes: genus 28, re-entrant edges everywhere.
  const Mesh frame = voxels(
      5, 5, 5, [](int x, int y, int z) { return (x % 2 == 0) + (y % 2 == 0) + (z % 2 == 0) >= 2; });
  for (int round = 0; round < (rounds + 3) / 4; ++round)
    ASSERT_NO_FATAL_FAILURE(cut_both(frame, 6, random)) << "seed " << seed << ", round " << round;
}

}  // namespace
}  // namespace suture
