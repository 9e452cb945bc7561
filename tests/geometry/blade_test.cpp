// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <random>

#include "kernel/base/error.hpp"
#include "kernel/geometry/surface_blade.hpp"
#include "kernel/operations/cut_faces.hpp"
#include "tests/geometry/dyadic.hpp"
#include "tests/geometry/surfaces.hpp"

namespace suture {
namespace {

using namespace test;

std::vector<Dart> faces_cut(const TriangleSurface& surface, const Block& block) {
  Diagnostics diagnostics;
  return SurfaceBlade(surface, diagnostics).faces_cut(block.complex, block.places());
}

/// A square through a point with two sides, as two triangles.
TriangleSurface square(const Vec3& centre, const Vec3& u, const Vec3& v) {
  TriangleSurface s{"square", {}, {{0, 1, 2}, {0, 2, 3}}};
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    Vec3 p = centre;
    for (int a = 0; a < 3; ++a) p[a] += x * u[a] + y * v[a];
    s.points.push_back(p);
  }
  return s;
}

// Coarse lattices put corners, sides and planes of the blade exactly on centroids and
// links; fine ones do not.
TEST(SurfaceBlade, AgreesWithEveryFaceAgainstEveryTriangle) {
  std::size_t total = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const double unit = seed % 3 == 0 ? 0.5 : seed % 3 == 1 ? 0.25 : 1.0 / 1024;
    const Block block = jittered_block(4, 5, 3, seed % 2 ? 0 : 1.0 / 64, random);
    const TriangleSurface surface = random_surface(12, 40, unit, random);
    const std::vector<Dart> faces = faces_cut(surface, block);
    EXPECT_EQ(faces, every_face_against_every_triangle(surface, block));
    total += faces.size();
  }
  EXPECT_GT(total, 1000u);
}

TEST(SurfaceBlade, IsTheSameForAnyNumberOfThreads) {
  std::mt19937 random(7);
  const Block block = jittered_block(40, 40, 40, 1.0 / 64, random);
  TriangleSurface surface = sphere_surface({20, 20, 20}, 15, 3);
  Diagnostics diagnostics;
  const SurfaceBlade blade(surface, diagnostics);
  const std::vector<Dart> faces = blade.faces_cut(block.complex, block.places());
  EXPECT_GT(faces.size(), 3000u);
  for (const unsigned threads : {2u, 3u, 8u}) {
    const Workers workers(threads);
    EXPECT_EQ(blade.faces_cut(block.complex, block.places(), &workers), faces);
  }
}

// Cut faces are those between an element inside and one outside, no more and no less.
TEST(SurfaceBlade, ClosedSurfacesSeparateInsideFromOutside) {
  std::mt19937 random(11);
  const Block block = jittered_block(12, 12, 12, 1.0 / 64, random);
  const TriangleSurface ball = sphere_surface({6.01, 5.97, 6.03}, 4.2, 2);
  std::vector<char> inside(block.complex.element_count());
  for (Index e = 0; e < inside.size(); ++e)
    inside[e] = winding(ball, xyz(centroid_of(block.complex.vertices_of(e), block.places()))) > 0.5;
  std::vector<Dart> expected;
  for (Index e = 0; e < inside.size(); ++e)
    for (int f = 0; f < 6; ++f) {
      const Index n = block.complex.neighbour(e, f);
      if (n != none && e < n && inside[e] != inside[n]) expected.push_back(24 * e + 4 * f);
    }
  EXPECT_EQ(faces_cut(ball, block), expected);
  EXPECT_GT(expected.size(), 200u);
}

// ----------------------------------------------------------------- the plane --

TEST(SurfaceBlade, TwoLargeTrianglesCutAsThePlane) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int round = 0; round < 20; ++round) {
    const Block block = jittered_block(6, 6, 6, 1.0 / 64, random);
    const Vec3 u{uniform(random), uniform(random), uniform(random)};
    const Vec3 v{uniform(random), uniform(random), uniform(random)};
    const Vec3 point{3 + uniform(random), 3 + uniform(random), 3 + uniform(random)};
    const Vec3 n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    if (std::hypot(n[0], n[1], n[2]) < 0.2) continue;
    const Vec3 far_u{100 * u[0], 100 * u[1], 100 * u[2]}, far_v{100 * v[0], 100 * v[1], 100 * v[2]};
    EXPECT_EQ(faces_cut(square(point, far_u, far_v), block),
              faces_across_plane(block.complex, block.rows.data(), point, n));
  }
}

TEST(SurfaceBlade, CentroidsOnThePlaneCountAsPositive) {
  const Block block = block_of(4, 4, 4);
  const Vec3 x{10, 0, 0}, y{0, 10, 0};
  const TriangleSurface up = square({2, 2, 1.5}, x, y), down = square({2, 2, 1.5}, y, x);
  for (const auto& [surface, layer] : {std::pair{up, 1.0}, {down, 2.0}}) {
    const std::vector<Dart> faces = faces_cut(surface, block);
    EXPECT_EQ(faces.size(), 16u);
    for (const Dart d : faces) EXPECT_EQ(block.rows[4 * block.complex.origin(d) + 2], layer);
  }
}

// --------------------------------------------------------------- documented rules --

TEST(SurfaceBlade, AlongFacesCutsJustThem) {
  const Block block = block_of(4, 4, 4);
  // Over 2 x 2 faces of the layer z = 2.
  const std::vector<Dart> faces = faces_cut(square({1, 1, 2}, {1, 0, 0}, {0, 1, 0}), block);
  EXPECT_EQ(faces.size(), 4u);
  for (const Dart d : faces)
    for (Dart k = 0; k < 4; ++k) {
      const double* p = &block.rows[4 * block.complex.origin(d + k)];
      EXPECT_TRUE(p[0] <= 2 && p[1] <= 2 && p[2] == 2);
    }
}

TEST(SurfaceBlade, TangentToTheMeshCutsNothing) {
  const Block block = block_of(4, 4, 4);
  EXPECT_TRUE(faces_cut(square({2, 2, 4}, {9, 0, 0}, {0, 9, 0}), block).empty());
  EXPECT_TRUE(faces_cut(square({0, 0, 2}, {1, 1, 0}, {0, 0, 9}), block).empty() == false);
  EXPECT_TRUE(faces_cut(square({0, 0, 2}, {1, -1, 0}, {0, 0, 9}), block).empty());
}

// The border ends exactly on the links x = 1.5: it belongs to the blade.
TEST(SurfaceBlade, TheBorderOfAnOpenBladeCuts) {
  const Block block = block_of(3, 3, 3);
  EXPECT_EQ(faces_cut(square({0.75, 1.5, 1}, {0.75, 0, 0}, {0, 9, 0}), block).size(), 6u);
  EXPECT_EQ(faces_cut(square({0.5, 1.5, 1}, {0.75, 0, 0}, {0, 9, 0}), block).size(), 3u);
}

// The links' common point is a corner of eight triangles: each link is there once.
TEST(SurfaceBlade, ThroughACornerOfTheBladeCutsOnce) {
  const Block block = block_of(2, 2, 2);
  TriangleSurface fan{"fan", {{0.5, 0.5, 1}}, {}};
  for (const auto& [x, y] :
       {std::pair{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}})
    fan.points.push_back({0.5 + 0.25 * x, 0.5 + 0.25 * y, 1});
  for (Index i = 1; i <= 8; ++i) fan.triangles.push_back({0, i, i % 8 + 1});
  EXPECT_EQ(faces_cut(fan, block).size(), 1u);
}

TEST(SurfaceBlade, LinksInItsPlaneAreNotCrossed) {
  const Block block = block_of(3, 3, 3);
  // In the plane of the middle layer of centroids: only links down from it are cut.
  const std::vector<Dart> faces = faces_cut(square({1.5, 1.5, 1.5}, {1, 0, 0}, {0, 1, 0}), block);
  EXPECT_EQ(faces.size(), 9u);
  for (const Dart d : faces) EXPECT_EQ(block.rows[4 * block.complex.origin(d) + 2], 1.0);
}

TEST(SurfaceBlade, PassesOverRemovedElements) {
  Block block = block_of(3, 3, 3);
  const TriangleSurface plane = square({1.5, 1.5, 1}, {9, 0, 0}, {0, 9, 0});
  EXPECT_EQ(faces_cut(plane, block).size(), 9u);
  const std::vector<Index> gone{0, 13};  // in the lowest layer, and in the middle
  block.complex.pierce(gone);
  EXPECT_EQ(faces_cut(plane, block).size(), 7u);
}

TEST(SurfaceBlade, SaysWhatIsWrong) {
  Diagnostics diagnostics;
  const auto error = [&](const TriangleSurface& surface) {
    return error_of<InputError>([&] { SurfaceBlade(surface, diagnostics); });
  };
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}};
  EXPECT_NE(error({"b", points, {}}).find("b: the blade has no triangles"), std::string::npos);
  EXPECT_NE(error({"b", points, {{0, 1, 4}}}).find("uses point 4"), std::string::npos);
  EXPECT_NE(error({"b", points, {{0, 1, 2}}}).find("all triangles of the blade are degenerate"),
            std::string::npos);
  std::vector<Vec3> bad = points;
  bad[3][1] = std::numeric_limits<double>::infinity();
  EXPECT_NE(error({"b", bad, {{0, 1, 3}}}).find("point 3 of the blade is not finite"),
            std::string::npos);
  EXPECT_TRUE(diagnostics.warnings().empty());
  EXPECT_EQ(error({"b", points, {{0, 1, 2}, {0, 1, 3}}}), "");
  ASSERT_EQ(diagnostics.warnings().size(), 1u);
  EXPECT_NE(diagnostics.warnings()[0].find("1 triangle without area"), std::string::npos);
}

TEST(SurfaceBlade, SaysWhyNothingWasCut) {
  const Block block = block_of(2, 2, 2);
  const auto why = [&](const TriangleSurface& s) {
    EXPECT_TRUE(faces_cut(s, block).empty());
    return why_nothing_was_cut(box_of(s.points), block.complex, block.places());
  };
  EXPECT_NE(why(square({9, 9, 9}, {1, 0, 0}, {0, 1, 0})).find("outside the body"),
            std::string::npos);
  EXPECT_NE(why(square({1, 1, 0.25}, {1, 0, 0}, {0, 1, 0}))
                .find("between the centroids of any two elements that share a face"),
            std::string::npos);
}

}  // namespace
}  // namespace suture
