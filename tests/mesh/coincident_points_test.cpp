// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/mesh/coincident_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "kernel/base/vec3.hpp"
#include "kernel/mesh/box.hpp"

namespace suture {
namespace {

// The same by comparing every point with every earlier one.
std::vector<Index> compared_one_by_one(const std::vector<Vec3>& points, double tolerance) {
  std::vector<Index> first(points.size());
  for (Index p = 0; p < points.size(); ++p) {
    first[p] = p;
    double least = tolerance;
    for (Index q = 0; q < p; ++q) {
      const double distance = norm(minus(points[p], points[q]));
      if (first[q] != q || distance > least || (distance == least && first[p] != p)) continue;
      least = distance;
      first[p] = q;
    }
  }
  return first;
}

TEST(CoincidentPoints, AreThoseOfAComparisonOneByOne) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1, 1);
  for (const double tolerance : {1e-3, 0.05, 0.3}) {
    std::vector<Vec3> points;
    for (int i = 0; i < 500; ++i) {
      points.push_back({place(random), place(random), place(random)});
      if (i % 3 == 0) {  // a copy nearby
        Vec3 near = points[random() % points.size()];
        for (double& x : near) x += 0.6 * tolerance * place(random);
        points.push_back(near);
      }
    }
    const std::vector<Index> first = first_in_place(points, tolerance);
    EXPECT_EQ(first, compared_one_by_one(points, tolerance));
    EXPECT_GT(std::ranges::count_if(first, [n = Index{0}](Index f) mutable { return f != n++; }),
              50);
  }
}

TEST(CoincidentPoints, PointsThatAreNotFiniteMatchNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vec3> points{{nan, 0, 0}, {nan, 0, 0}, {1e300, 0, 0}, {1e300, 0, 0}};
  EXPECT_EQ(first_in_place(points, 1), (std::vector<Index>{0, 1, 2, 2}));
}

/// Two boxes of two elements side by side, each with points of its own.
Mesh two_boxes() {
  Mesh mesh = make_box({{0, 0, 0}, {1, 1, 1}, {1, 1, 2}, {1, 1, 1}});
  const auto points = static_cast<Index>(mesh.points.size());
  const std::vector<Hexahedron> hexahedra = mesh.hexahedra;
  for (Index p = 0; p < points; ++p) mesh.points.push_back(plus(mesh.points[p], {1 + 1e-7, 0, 0}));
  for (Hexahedron nodes : hexahedra) {
    for (Index& node : nodes) node += points;
    mesh.hexahedra.push_back(nodes);
  }
  mesh.point_sets = {{"right", {points, points + 1}}};
  MeshArray array;
  array.name = "number";
  for (Index p = 0; p < 2 * points; ++p) array.values.push_back(p);
  mesh.arrays = {array};
  return mesh;
}

TEST(CoincidentPoints, MergedOnesAreOneForCellsSetsAndArrays) {
  const Mesh before = two_boxes();
  Mesh mesh = before;
  EXPECT_EQ(merge_points(mesh, 1e-9), 0u);
  EXPECT_EQ(mesh.points, before.points);
  EXPECT_EQ(merge_points(mesh, 1e-6), 6u);
  ASSERT_EQ(mesh.points.size(), 18u);
  for (std::size_t e = 0; e < mesh.hexahedra.size(); ++e)
    for (std::size_t n = 0; n < 8; ++n)
      EXPECT_LT(
          norm(minus(mesh.points[mesh.hexahedra[e][n]], before.points[before.hexahedra[e][n]])),
          1e-6);
  // The array has held the numbers of the points.
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
    EXPECT_EQ(mesh.arrays[0].values[p], static_cast<double>(mesh.point_ids[p]));
  for (const Index p : mesh.point_sets.at("right")) EXPECT_LT(p, mesh.points.size());
}

}  // namespace
}  // namespace suture
