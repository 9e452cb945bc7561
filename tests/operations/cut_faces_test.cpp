// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/operations/cut_faces.hpp"

#include <gtest/gtest.h>

#include "kernel/base/error.hpp"
#include "tests/topology/meshes.hpp"

namespace suture {
namespace {

using namespace meshes;

std::vector<double> rows_of(const Mesh& mesh, std::size_t stride, double scale = 1) {
  std::vector<double> rows(mesh.points.size() * stride, -77);
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    for (std::size_t c = 0; c < 3; ++c) rows[stride * v + c] = scale * mesh.points[v][c];
  return rows;
}

TEST(FacesAcrossPlane, AreTheLayerBetweenTwoCentroids) {
  const Mesh mesh = grid(4, 3, 5);
  const CellComplex map = complex_of(mesh);
  for (const std::size_t stride : {std::size_t{3}, std::size_t{4}}) {
    const std::vector<double> rows = rows_of(mesh, stride);
    const auto faces = faces_across_plane(map, rows.data(), {0, 0, 2.2}, {0, 0, -3}, stride);
    ASSERT_EQ(faces.size(), 12u);  // between centroids at 1.5 and 2.5
    EXPECT_TRUE(std::ranges::is_sorted(faces));
    for (const Dart d : faces)
      for (Dart k = 0; k < 4; ++k) EXPECT_EQ(mesh.points[map.origin(d + k)][2], 2.0);
  }
}

TEST(FacesAcrossPlane, CentroidsOnThePlaneCountAsPositive) {
  // Scaled so that no coordinate is a binary fraction: exact in the mathematical
  // sense, not in floating point.
  const Mesh mesh = grid(3, 3, 3);
  const CellComplex map = complex_of(mesh);
  for (const double scale : {1.0, 0.1, 1.0 / 3, 1e-3 / 7}) {
    const std::vector<double> rows = rows_of(mesh, 4, scale);
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 point{}, up{}, down{};
      point[axis] = 1.5 * scale;
      up[axis] = 1;
      down[axis] = -1;
      const auto height = [&](const std::vector<Dart>& faces) {
        EXPECT_EQ(faces.size(), 9u);
        return faces.empty() ? -1.0 : mesh.points[map.origin(faces[0])][axis];
      };
      EXPECT_EQ(height(faces_across_plane(map, rows.data(), point, up)), 1.0);
      EXPECT_EQ(height(faces_across_plane(map, rows.data(), point, down)), 2.0);
    }
  }
}

TEST(FacesAcrossPlane, CentroidsOnAnObliquePlaneCountAsPositive) {
  // The diagonal plane x = y, far from the origin: coordinates of 1000 cancel.
  Mesh mesh = grid(5, 5, 1);
  const CellComplex map = complex_of(mesh);
  for (Vec3& p : mesh.points) p = {1000 + 0.1 * p[0], 1000 + 0.1 * p[1], p[2]};
  const std::vector<double> rows = rows_of(mesh, 4);
  for (const Vec3 normal : {Vec3{1, -1, 0}, Vec3{-1, 1, 0}}) {
    const auto faces = faces_across_plane(map, rows.data(), {1000, 1000, 0}, normal);
    EXPECT_EQ(faces.size(), 8u);
    for (const Dart d : faces) {  // diagonal elements stay on the side of the normal
      Index e = d / 24, other = map.beta3(d) / 24;
      if (e % 5 != e / 5) std::swap(e, other);
      EXPECT_EQ(e % 5, e / 5);
      const double away = (double(other % 5) - double(other / 5)) * normal[0];
      EXPECT_LT(away, 0);
    }
  }
}

TEST(FacesAcrossPlane, SeparateWhatLiesOnDifferentSides) {
  const unsigned seed = 99;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 20; ++round) {
    const Mesh mesh = blob(5, 0.7, random);
    CellComplex map = complex_of(mesh);
    // Non-manifold vertices were split: positions by the elements' corners.
    std::vector<double> rows;
    const auto place = [&] {
      rows.resize(4 * std::size_t{map.count(0)});
      for (Index e = 0; e < map.element_count(); ++e)
        for (int i = 0; i < 8; ++i)
          std::ranges::copy(mesh.points[mesh.hexahedra[e][i]], &rows[4 * map.vertices_of(e)[i]]);
    };
    place();
    const Vec3 p{2.4, 2.6, 2.55}, n{normal(random), normal(random), normal(random)};
    const auto faces = faces_across_plane(map, rows.data(), p, n);
    const auto side = [&](Index e) {
      double d = 0;
      for (const Index v : mesh.hexahedra[e])
        for (int c = 0; c < 3; ++c) d += n[c] * (mesh.points[v][c] - p[c]);
      return d > 0;
    };
    for (const Dart d : faces) EXPECT_NE(side(d / 24), side(map.beta3(d) / 24));
    map.cut(faces);
    place();
    const std::vector<Index> island = map.islands();
    std::vector<int> side_of(map.element_count(), -1);
    for (Index e = 0; e < map.element_count(); ++e) {
      if (side_of[island[e]] < 0) side_of[island[e]] = side(e);
      EXPECT_EQ(side_of[island[e]], int(side(e)));
    }
    EXPECT_TRUE(faces_across_plane(map, rows.data(), p, n).empty());
  }
}

TEST(FacesAcrossPlane, MissesOrRefusesPlanesThatAreNone) {
  const Mesh mesh = two_cubes();
  const CellComplex map = complex_of(mesh);
  const std::vector<double> rows = rows_of(mesh, 4);
  EXPECT_TRUE(faces_across_plane(map, rows.data(), {9, 9, 9}, {1, 0, 0}).empty());
  EXPECT_THROW(faces_across_plane(map, rows.data(), {0, 0, 0}, {0, 0, 0}), InputError);
  EXPECT_THROW(faces_across_plane(map, rows.data(), {0, std::nan(""), 0}, {1, 0, 0}), InputError);
  EXPECT_THROW(faces_across_plane(map, rows.data(), {0, 0, 0}, {INFINITY, 0, 0}), InputError);
}

TEST(FacesBetween, FindsFacesByTheUsersNumbersAndListsAllFaults) {
  const Mesh mesh = grid(3, 1, 1);
  CellComplex map = complex_of(mesh);
  const auto element_of = [](std::uint64_t id) {
    return id >= 100 && id < 103 ? static_cast<Index>(id - 100) : none;
  };
  std::vector<Index> point(map.count(0));
  std::iota(point.begin(), point.end(), Index{0});
  const std::vector<ElementPair> good{{101, 100}, {101, 102}};
  const ListedFaces found = faces_between(map, "/events/0/faces", good, element_of, point);
  EXPECT_EQ(found.faces, (std::vector<Dart>{24, 24 + 8}));
  EXPECT_TRUE(found.already_cut.empty());

  const std::vector<ElementPair> bad{{100, 101}, {100, 102}, {100, 7}, {101, 101}};
  try {
    faces_between(map, "/events/0/faces", bad, element_of, point);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              "/events/0/faces/1: elements 100 and 102 are not neighbours: they have no common "
              "face\n/events/0/faces/2: the mesh has no element 7\n/events/0/faces/3: the pair "
              "contains element 101 twice; a face lies between two elements");
  }
}

TEST(FacesBetween, ReportsAFaceThatWasCutBefore) {
  CellComplex map = complex_of(grid(3, 1, 1));
  std::vector<Index> point(map.count(0));
  std::iota(point.begin(), point.end(), Index{0});
  const auto element_of = [](std::uint64_t id) { return static_cast<Index>(id); };
  const TopologyChange change = map.cut(std::array<Dart, 1>{8});
  for (const Split& split : change.splits[0]) point.push_back(point[split.old_cell]);
  const std::vector<ElementPair> pairs{{0, 1}, {1, 2}};
  const ListedFaces found = faces_between(map, "/events/1/faces", pairs, element_of, point);
  EXPECT_EQ(found.faces.size(), 1u);
  EXPECT_EQ(found.already_cut, (std::vector<ElementPair>{{0, 1}}));
  EXPECT_THROW(face_between(map, "/events/1", {0, 1}, element_of), InputError);
  map.pierce(std::array<Index, 1>{2});
  const ListedFaces left = faces_between(map, "/events/2/faces", pairs, element_of, point);
  EXPECT_EQ(left.already_cut, (std::vector<ElementPair>{{0, 1}}));
  EXPECT_EQ(left.removed, (std::vector<ElementPair>{{1, 2}})) << "no cut took it";
}

}  // namespace
}  // namespace suture
