// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/voxelize.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "kernel/base/error.hpp"
#include "kernel/geometry/surface_file.hpp"
#include "kernel/topology/import.hpp"
#include "tests/geometry/surfaces.hpp"

namespace suture {
namespace {

using test::box_surface;
using test::error_of;
using test::joined;
using test::soup_of;
using test::sphere_surface;

Mesh voxels(const TriangleSurface& surface, const VoxelizeOptions& options) {
  Diagnostics diagnostics;
  return voxelize(surface, options, diagnostics);
}

Vec3 centre_of(const Mesh& mesh, const Hexahedron& h) {
  Vec3 c{};
  for (const Index p : h)
    for (int a = 0; a < 3; ++a) c[a] += mesh.points[p][a] / 8;
  return c;
}

TEST(Voxelize, FillsABoxExactly) {
  const Mesh mesh = voxels(box_surface({1, 2, 3}, {3, 3, 6}), {.edge = 0.25});
  EXPECT_EQ(mesh.hexahedra.size(), 8u * 4 * 12);
  EXPECT_EQ(mesh.points.size(), 9u * 5 * 13);
  const Box box = box_of(mesh.points);
  EXPECT_EQ(box.low, (Vec3{1, 2, 3}));
  EXPECT_EQ(box.high, (Vec3{3, 3, 6}));
  EXPECT_EQ(mesh.hexahedra[0], (Hexahedron{0, 1, 2, 3, 4, 5, 6, 7}));
}

// 0.4 / 0.0333... is a little more than 12, which must not add a layer.
TEST(Voxelize, HasTheLengthOfTheBodyWhereTheEdgeDividesIt) {
  for (const int layers : {3, 7, 12, 29}) {
    const double edge = std::nextafter(0.4 / layers, 0);
    const Mesh mesh = voxels(box_surface({0, 0, 0}, {0.1, 0.1, 0.4}), {.edge = edge});
    const Box box = box_of(mesh.points);
    EXPECT_NEAR(box.low[2], 0, 1e-15) << layers;
    EXPECT_NEAR(box.high[2], 0.4, 1e-15) << layers;
  }
  // A layer that is filled by a hundredth stays.
  const Mesh more = voxels(box_surface({0, 0, 0}, {1, 1, 3.01}), {.edge = 1});
  EXPECT_EQ(more.hexahedra.size(), 4u);
}

// Centres on the surface: entering a body on a centre is inside, leaving it outside, and
// no edge or corner on a row of centres lets parity slip.
TEST(Voxelize, CentresOnTheSurfaceAreDecidedOnce) {
  // The lattice of a box of 5 cubes of 1 around a body: centres at -2, -1, 0, 1, 2.
  const TriangleSurface outer = box_surface({-2.5, -2.5, -2.5}, {2.5, 2.5, 2.5});
  TriangleSurface hole = box_surface({-1, -1, -1}, {1, 1, 1});
  for (Triangle& t : hole.triangles) std::swap(t[1], t[2]);
  const Mesh mesh = voxels(joined(outer, hole), {.edge = 1});
  // The hole takes centres -1 and 0 of each axis, not 1: 2^3 of 125.
  EXPECT_EQ(mesh.hexahedra.size(), 125u - 8);
}

// Another method for the same question: the solid angle of the surface.
TEST(Voxelize, AgreesWithTheSolidAngle) {
  const unsigned seed = 20260;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-0.4, 0.4);
  for (int round = 0; round < 4; ++round) {
    TriangleSurface surface = sphere_surface({place(random), place(random), place(random)}, 0.6, 2);
    for (Vec3& p : surface.points)
      for (double& x : p) x *= 1 + 0.1 * place(random);
    const double edge = 0.09;
    const Mesh mesh = voxels(surface, {.edge = edge});
    std::set<Vec3> filled;
    for (const Hexahedron& h : mesh.hexahedra) filled.insert(centre_of(mesh, h));
    for (const Vec3& c : filled) EXPECT_NEAR(test::winding(surface, c), 1, 1e-6);
    const Box box = box_of(surface.points);
    std::size_t inside = 0;
    std::array<int, 3> n;
    for (int a = 0; a < 3; ++a) n[a] = int(std::ceil((box.high[a] - box.low[a]) / edge));
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i) {
          const std::array<int, 3> at{i, j, k};
          Vec3 c;
          for (int a = 0; a < 3; ++a)
            c[a] = (box.low[a] + box.high[a]) / 2 + (at[a] + 0.5 - n[a] / 2.0) * edge;
          inside += test::winding(surface, c) > 0.5 ? 1 : 0;
        }
    EXPECT_EQ(inside, filled.size());
    EXPECT_GT(inside, 500u);
  }
}

TEST(Voxelize, FindsTheEdgeForANumberOfCells) {
  const double volume = 4.18;  // of a ball of radius 1, a little less
  const TriangleSurface ball = sphere_surface({3, -2, 1}, 1, 4);
  for (const std::size_t cells : {500, 4000, 30000}) {
    const Mesh mesh = voxels(ball, {.cells = cells});
    EXPECT_NEAR(double(mesh.hexahedra.size()), double(cells), 0.01 * double(cells));
    const double edge = mesh.points[1][0] - mesh.points[0][0];
    EXPECT_NEAR(double(mesh.hexahedra.size()) * edge * edge * edge, volume, 0.03 * volume);
  }
}

TEST(Voxelize, KeepsTheLargestIsland) {
  const TriangleSurface two =
      joined(box_surface({0, 0, 0}, {2, 1, 1}), box_surface({4, 0, 0}, {7, 1, 1}));
  EXPECT_EQ(voxels(two, {.edge = 0.5}).hexahedra.size(), 40u);
  const Mesh mesh = voxels(two, {.edge = 0.5, .largest_island = true});
  EXPECT_EQ(mesh.hexahedra.size(), 24u);
  EXPECT_EQ(box_of(mesh.points).low[0], 4);
}

// One cube around a body of an eighth of it, and far more than it.
TEST(Voxelize, WarnsOfCubesThatDoNotFollowTheBody) {
  const TriangleSurface box = box_surface({0, 0, 0}, {1, 1, 1});
  Diagnostics diagnostics;
  voxelize(box, {.edge = 1.2}, diagnostics);
  EXPECT_TRUE(diagnostics.warnings().empty());
  EXPECT_EQ(voxelize(box, {.edge = 2}, diagnostics).hexahedra.size(), 1u);
  ASSERT_EQ(diagnostics.warnings().size(), 1u);
  EXPECT_NE(diagnostics.warnings()[0].find("8 times the volume of the body of 1 x 1 x 1 m"),
            std::string::npos)
      << diagnostics.warnings()[0];
}

// Cubes are looked for in the whole bounding box.
TEST(Voxelize, RefusesAPointAstray) {
  TriangleSurface spike = box_surface({0, 0, 0}, {1, 1, 1});
  spike.points[0][1] = -1e4;
  EXPECT_EQ(voxels(spike, {.edge = 1}).hexahedra.empty(), false);
  for (Vec3& p : spike.points) p[2] += 100 * p[1];
  const std::string error = test::error_of<InputError>([&] { voxels(spike, {.cells = 100}); });
  EXPECT_NE(error.find("along z; check for stray points"), std::string::npos) << error;
}

// Two boxes that touch along an edge: one body for the centres, two for the map.
TEST(Voxelize, SplitsNonManifoldVertices) {
  const TriangleSurface two =
      joined(box_surface({0, 0, 0}, {1, 1, 2}), box_surface({1, 1, 0}, {2, 2, 2}));
  Diagnostics diagnostics;
  const Mesh mesh = voxelize(two, {.edge = 0.5}, diagnostics);
  EXPECT_EQ(mesh.hexahedra.size(), 2u * 2 * 2 * 4);
  EXPECT_EQ(mesh.points.size(), 2u * 3 * 3 * 5);
  ASSERT_EQ(diagnostics.warnings().size(), 1u);
  EXPECT_NE(diagnostics.warnings()[0].find("5 vertices"), std::string::npos)
      << diagnostics.warnings()[0];
  // What was written is no longer non-manifold.
  Diagnostics again;
  const Imported imported = import_mesh(mesh, {}, again);
  EXPECT_TRUE(again.warnings().empty());
  EXPECT_EQ(imported.complex.count(0), mesh.points.size());
}

TEST(Voxelize, SaysWhatIsWrong) {
  const TriangleSurface box = box_surface({0, 0, 0}, {1, 1, 1});
  const auto error = [](const TriangleSurface& s, const VoxelizeOptions& o) {
    return error_of<InputError>([&] { voxels(s, o); });
  };
  EXPECT_NE(error(box, {}).find("give either"), std::string::npos);
  EXPECT_NE(error(box, {.cells = 10, .edge = 1}).find("give either"), std::string::npos);
  EXPECT_NE(error(box, {.edge = std::nan("")}).find("positive"), std::string::npos);
  EXPECT_NE(error({"nothing", {}, {}}, {.cells = 10}).find("nothing: the surface is empty"),
            std::string::npos);
  EXPECT_NE(error(box, {.cells = 100'000'000}).find("67,108,863"), std::string::npos);
  EXPECT_NE(error(box, {.edge = 1e-6}).find("too small"), std::string::npos);
  // A slab thinner than the distance of its plane to the centres of the cubes around it.
  const TriangleSurface slab =
      joined(box_surface({0, 0, 0}, {1, 0.01, 1}), box_surface({0, 0.99, 0}, {1, 1, 1}));
  EXPECT_NE(error(slab, {.edge = 0.5}).find("no cube"), std::string::npos);
}

// ------------------------------------------------------------ close_surface --

TEST(CloseSurface, MergesTurnsAndTriangulates) {
  // A cube of six squares, each with points of its own, every second one turned.
  const TriangleSurface box = box_surface({0, 0, 0}, {1, 1, 1});
  PolygonSoup soup{"squares", {}, {}, {0}};
  for (std::size_t s = 0; s < 6; ++s) {
    const Triangle t = box.triangles[2 * s], u = box.triangles[2 * s + 1];
    std::array<Index, 4> corners{t[0], t[1], t[2], u[2]};
    if (s % 2) std::swap(corners[1], corners[3]);
    for (const Index c : corners) {
      soup.corners.push_back(static_cast<Index>(soup.points.size()));
      soup.points.push_back(box.points[c]);
    }
    soup.offsets.push_back(static_cast<Index>(soup.corners.size()));
  }
  Diagnostics diagnostics;
  const TriangleSurface closed = close_surface(soup, false, diagnostics);
  EXPECT_EQ(closed.points.size(), 8u);
  EXPECT_EQ(closed.triangles.size(), 12u);
  EXPECT_NEAR(test::winding(closed, {0.3, 0.4, 0.5}), 1, 1e-12);
  EXPECT_TRUE(diagnostics.warnings().empty());
}

TEST(CloseSurface, RefusesOrFillsAHole) {
  PolygonSoup soup = soup_of(sphere_surface({0, 0, 0}, 1, 3));
  const std::size_t whole = voxels(sphere_surface({0, 0, 0}, 1, 3), {.edge = 0.1}).hexahedra.size();
  soup.offsets.pop_back();
  Diagnostics diagnostics;
  const std::string text = error_of<InputError>([&] { close_surface(soup, false, diagnostics); });
  EXPECT_NE(text.find("sphere: the surface is not closed: 3 edges have"), std::string::npos)
      << text;
  EXPECT_NE(text.find("--repair"), std::string::npos);
  const TriangleSurface closed = close_surface(soup, true, diagnostics);
  EXPECT_EQ(closed.triangles.size(), 1280u);
  ASSERT_EQ(diagnostics.warnings().size(), 1u);
  EXPECT_NE(diagnostics.warnings()[0].find("1 hole was filled"), std::string::npos);
  EXPECT_EQ(voxels(closed, {.edge = 0.1}).hexahedra.size(), whole);
}

TEST(CloseSurface, RefusesOrUnitesWhatCrosses) {
  const PolygonSoup soup = soup_of(
      joined(box_surface({0, 0, 0}, {2, 2, 2}), box_surface({1.125, 1.125, 1.125}, {3, 3, 3})));
  Diagnostics diagnostics;
  const std::string text = error_of<InputError>([&] { close_surface(soup, false, diagnostics); });
  EXPECT_NE(text.find("intersects itself"), std::string::npos) << text;
  const TriangleSurface closed = close_surface(soup, true, diagnostics);
  // Centres at 0.125 + i / 4: 8^3 below 2, 7^3 above 1.125 with that on it, 4^3 in both.
  EXPECT_EQ(voxels(closed, {.edge = 0.25}).hexahedra.size(), 512u + 512 - 64);
}

TEST(CloseSurface, LeavesAHollowHollow) {
  // Both outward, as a file may have them: orientation is found by nesting.
  const PolygonSoup soup =
      soup_of(joined(box_surface({0, 0, 0}, {4, 4, 4}), box_surface({1, 1, 1}, {3, 3, 3})));
  Diagnostics diagnostics;
  const TriangleSurface closed = close_surface(soup, false, diagnostics);
  EXPECT_EQ(voxels(closed, {.edge = 0.5}).hexahedra.size(), 512u - 64);
}

// Faces that fold back onto themselves: CGAL cannot divide them, and its borders have no end then.
TEST(CloseSurface, RefusesFoldedFaces) {
  const auto folded = [](std::vector<Vec3> points) {
    PolygonSoup soup{"folded", std::move(points), {}, {0}};
    for (Index i = 0; i < soup.points.size(); ++i) soup.corners.push_back(i);
    soup.offsets.push_back(static_cast<Index>(soup.points.size()));
    return soup;
  };
  Diagnostics diagnostics;
  for (const PolygonSoup& soup :
       {folded({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}, {1, 1, 0}}),
        folded({{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, {0, 1, -1}})})
    for (const bool repair : {false, true}) {
      const std::string text =
          error_of<InputError>([&] { close_surface(soup, repair, diagnostics); });
      EXPECT_NE(text.find("folded: a face of 5 corners around ["), std::string::npos) << text;
      EXPECT_NE(text.find("folds back onto itself"), std::string::npos) << text;
    }
}

// Two boxes, each closed, whose common wall is there once for each of them: one body of both.
TEST(CloseSurface, JoinsShellsThatShareAWall) {
  const TriangleSurface boxes =
      joined(box_surface({0, 0, 0}, {1, 1, 1}), box_surface({1, 0, 0}, {2, 1, 1}));
  Diagnostics diagnostics;
  const TriangleSurface closed = close_surface(soup_of(boxes), false, diagnostics);
  EXPECT_EQ(closed.triangles.size(), 20u);
  EXPECT_EQ(closed.points.size(), 12u);
  EXPECT_EQ(voxels(closed, {.edge = 0.25}).hexahedra.size(), 128u);
}

}  // namespace
}  // namespace suture
