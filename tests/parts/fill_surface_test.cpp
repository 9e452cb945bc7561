// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/fill_surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "kernel/base/error.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/parts/embedding.hpp"
#include "kernel/topology/disjoint_sets.hpp"
#include "kernel/topology/import.hpp"
#include "tests/geometry/surfaces.hpp"
#include "tests/parts/filled_mesh.hpp"

namespace suture {
namespace {

using test::box_surface;
using test::edge_of;
using test::error_of;
using test::joined;
using test::sphere_surface;
using test::volume_of;

Mesh filled(const TriangleSurface& surface, const CubeSize& size) {
  Diagnostics diagnostics;
  return fill_surface(surface, size, diagnostics);
}

double enclosed_volume(const TriangleSurface& surface) {
  double six = 0;
  for (const auto& [a, b, c] : surface.triangles)
    six += dot(surface.points[a], cross(surface.points[b], surface.points[c]));
  return six / 6;
}

/// What a viewer sees.
struct Shown {
  Imported imported;
  Parts parts;
  Embedding embedding;
  TriangleSurface surface;
  std::vector<std::string> warnings;

  explicit Shown(const Mesh& mesh) {
    Diagnostics diagnostics;
    imported = import_mesh(mesh, {}, diagnostics);
    parts = renumbered(mesh.parts, imported.element_of);
    warnings = diagnostics.warnings();
    take();
  }
  void take() {
    embedding = Embedding(parts, imported.complex);
    surface = {};
    for (std::size_t p = 0; p < embedding.points.size(); ++p) {
      Vec3& x = surface.points.emplace_back();
      for (std::size_t a = 0; a < 3; ++a)
        x[a] = embedding.points.value(p, imported.rest[0].data(), 3, a);
    }
    surface.triangles = embedding.triangles;
  }
};

/// Each edge has a triangle on both of its sides, in opposite directions, and the triangles around
/// each point form one fan. Returns the number of connected surfaces.
std::size_t expect_manifold(const TriangleSurface& surface) {
  std::map<std::pair<Index, Index>, std::size_t> side;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (int i = 0; i < 3; ++i) {
      const std::pair edge(surface.triangles[t][i], surface.triangles[t][(i + 1) % 3]);
      EXPECT_TRUE(side.emplace(edge, 3 * t + i).second) << "an edge twice in one direction";
    }
  DisjointSets fans(3 * surface.triangles.size()), surfaces(surface.triangles.size());
  for (const auto& [edge, corner] : side) {
    const auto other = side.find({edge.second, edge.first});
    if (other == side.end()) {
      ADD_FAILURE() << "an open edge";
      continue;
    }
    // At the start of this edge is the end of the other.
    fans.unite(corner, 3 * (other->second / 3) + (other->second + 1 - 3 * (other->second / 3)) % 3);
    surfaces.unite(corner / 3, other->second / 3);
  }
  std::map<Index, std::size_t> fan_of;
  for (std::size_t c = 0; c < 3 * surface.triangles.size(); ++c) {
    const auto [known, is_new] = fan_of.emplace(surface.triangles[c / 3][c % 3], fans.find(c));
    EXPECT_EQ(known->second, fans.find(c)) << "two fans at a point";
  }
  std::size_t count = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) count += surfaces.find(t) == t ? 1 : 0;
  return count;
}

/// What holds for every filled surface. Returns the number of connected surfaces.
std::size_t expect_sound(const Mesh& mesh) {
  const Shown shown(mesh);
  EXPECT_EQ(shown.warnings, std::vector<std::string>{});
  const double volume = volume_of(mesh);
  EXPECT_NEAR(enclosed_volume(shown.surface), volume, 1e-12 * volume);
  EXPECT_TRUE(std::ranges::none_of(shown.embedding.is_laid_open, [](auto x) { return x != 0; }));
  shown.imported.complex.validate();
  for (const PartMoments& moments : mesh.parts.moments) {
    EXPECT_GT(moments.fraction, 0);
    EXPECT_LT(moments.fraction, 1);
    for (const double x : moments.centroid) EXPECT_LT(std::abs(x), 1);
  }
  return expect_manifold(shown.surface);
}

/// Turned about three axes by random angles.
TriangleSurface turned(TriangleSurface surface, std::mt19937& random) {
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  for (int a = 0; a < 3; ++a) {
    const double c = std::cos(angle(random)), s = std::sqrt(1 - c * c);
    for (Vec3& p : surface.points) {
      const double u = p[(a + 1) % 3], v = p[(a + 2) % 3];
      p[(a + 1) % 3] = c * u - s * v;
      p[(a + 2) % 3] = s * u + c * v;
    }
  }
  return surface;
}

TriangleSurface reversed(TriangleSurface surface) {
  for (Triangle& t : surface.triangles) std::swap(t[1], t[2]);
  return surface;
}

/// A closed rod of 64 sides along z.
TriangleSurface rod(double radius, double length) {
  TriangleSurface surface;
  constexpr Index sides = 64;
  surface.points = {{0, 0, 0}, {0, 0, length}};
  for (Index i = 0; i < sides; ++i)
    for (const double z : {0.0, length}) {
      const double angle = 2 * std::numbers::pi * i / sides;
      surface.points.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
    }
  for (Index i = 0; i < sides; ++i) {
    const Index a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % sides);
    surface.triangles.insert(surface.triangles.end(),
                             {{0, b, a}, {1, a + 1, b + 1}, {a, b, b + 1}, {a, b + 1, a + 1}});
  }
  return surface;
}

// A box has flat sides only, which are exact wherever they lie in cubes. Its edges are chamfered:
// along them, at most a wedge of half an edge in width is lost.
TEST(FillSurface, FillsABoxAlongTheLattice) {
  const Mesh mesh = filled(box_surface({1, 2, 3}, {3, 3, 6}), {.edge = 0.25});
  EXPECT_EQ(expect_sound(mesh), 1u);
  EXPECT_EQ(mesh.hexahedra.size(), 9u * 5 * 13);
  const double along_edges = 4.0 * (2 + 1 + 3) * 0.25 * 0.25 / 8;
  EXPECT_LT(volume_of(mesh), 6);
  EXPECT_GT(volume_of(mesh), 6 - along_edges);
}

TEST(FillSurface, RandomShapesAreSound) {
  const unsigned seed = std::random_device{}() % 100000;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-0.3, 0.3), size(0.1, 0.5), part(0.05, 0.4);
  for (int round = 0; round < 12; ++round) {
    TriangleSurface surface;
    switch (round % 4) {
      case 0:
        surface = sphere_surface({place(random), place(random), place(random)}, size(random), 2);
        break;
      case 1:
        surface =
            turned(box_surface({0, 0, 0}, {size(random), size(random), size(random)}), random);
        break;
      case 2:
        surface = turned(rod(size(random) / 2, 1), random);
        break;
      default:  // a ball with bumps
        surface = sphere_surface({}, 0.4, 3);
        for (Vec3& p : surface.points) p = scaled(1 + place(random), p);
    }
    const double edge = part(random) * 0.3;
    if (enclosed_volume(surface) < 8 * std::pow(edge, 3)) continue;
    SCOPED_TRACE(round);
    expect_sound(filled(surface, {.edge = edge}));
  }
}

// Chords of a curved surface: a volume of order 2.
TEST(FillSurface, VolumesConvergeWithOrderTwo) {
  const unsigned seed = 20264;
  std::mt19937 random(seed);
  for (const TriangleSurface& surface :
       {sphere_surface({0.01, 0.02, 0.03}, 1, 6), turned(rod(1, 3), random)}) {
    const double exact = enclosed_volume(surface);
    std::vector<double> errors;
    for (const double edge : {1 / 3.1, 1 / 6.2, 1 / 12.4}) {
      const Mesh mesh = filled(surface, {.edge = edge});
      EXPECT_EQ(expect_sound(mesh), 1u);
      errors.push_back(std::abs(volume_of(mesh) / exact - 1));
    }
    EXPECT_LT(errors[0], 0.03);
    EXPECT_GT(std::log2(errors[0] / errors[2]) / 2, 1.7) << errors[0] << ' ' << errors[2];
  }
}

// Along the diagonal from X1 to X6, no edge of a tetrahedron is longer than 1.155 edges: a gap of
// 1.4 leaves corners of one cube on both of its sides. The walls share no node.
TEST(FillSurface, WallsInOneCubeAreApart) {
  std::size_t shared = 0;
  for (const double move : {0.0, 0.02, 0.07}) {
    SCOPED_TRACE(move);
    TriangleSurface walls =
        joined(box_surface({0, 0, 0.14}, {1, 1, 0.5}), box_surface({0, 0, -0.5}, {1, 1, 0}));
    for (Vec3& p : walls.points) {
      const double r2 = std::sqrt(2.0), r3 = std::sqrt(3.0), r6 = std::sqrt(6.0);
      const double u = p[0], v = p[1], w = p[2] + move;  // w along (1, -1, -1)
      p = {2 * v / r6 + w / r3, u / r2 + v / r6 - w / r3, -u / r2 + v / r6 - w / r3};
    }
    const Mesh mesh = filled(enclosed_volume(walls) > 0 ? walls : reversed(walls), {.edge = 0.1});
    EXPECT_EQ(expect_sound(mesh), 2u);
    Index islands = 0;
    Shown(mesh).imported.complex.islands(&islands);
    EXPECT_EQ(islands, 2u);
    std::map<Vec3, int> cubes;
    for (const Hexahedron& h : mesh.hexahedra) shared += ++cubes[mesh.points[h[0]]] == 2 ? 1 : 0;
  }
  EXPECT_GT(shared, 20u);
}

// At the bottom of a notch, both walls touch the same elements.
TEST(FillSurface, NotchesAreSound) {
  const unsigned seed = std::random_device{}() % 100000;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::size_t joined_pieces = 0;
  for (int round = 0; round < 8; ++round) {
    TriangleSurface u;  // the outline of a U, extruded along y
    const std::vector<std::array<double, 2>> outline{{0, 0},      {1, 0},      {1, 1},    {0.57, 1},
                                                     {0.53, 0.3}, {0.47, 0.3}, {0.43, 1}, {0, 1}};
    const auto m = static_cast<Index>(outline.size());
    for (const double y : {0.0, 0.4})
      for (const auto& [x, z] : outline) u.points.push_back({x, y, z});
    for (Index i = 0; i < m; ++i) {
      const Index j = (i + 1) % m;
      u.triangles.insert(u.triangles.end(), {{i, j, j + m}, {i, j + m, i + m}});
    }
    for (const auto& [a, b, c] :
         std::vector<Triangle>{{0, 5, 6}, {0, 6, 7}, {0, 1, 5}, {1, 4, 5}, {1, 2, 4}, {2, 3, 4}})
      u.triangles.insert(u.triangles.end(), {{a, c, b}, {a + m, b + m, c + m}});
    u = turned(u, random);
    Diagnostics diagnostics;
    const Mesh mesh =
        fill_surface(enclosed_volume(u) > 0 ? u : reversed(u), {.edge = 0.07}, diagnostics);
    expect_sound(mesh);
    Index islands = 0;
    Shown(mesh).imported.complex.islands(&islands);
    EXPECT_EQ(islands, 1u);
    for (const std::string& note : diagnostics.notes())
      joined_pieces += note.find("were joined") != note.npos ? 1 : 0;
  }
  EXPECT_GT(joined_pieces, 0u);
}

// A box that is smaller than a cube holds one corner, or none.
TEST(FillSurface, SpecksAreLeftOut) {
  std::size_t left_out = 0;
  for (int i = 0; i < 8; ++i) {
    const double x = 1.5 + 0.04 * i;
    Diagnostics diagnostics;
    const Mesh mesh = fill_surface(joined(box_surface({0, 0, 0}, {1, 1, 1}),
                                          box_surface({x, 0.41, 0.41}, {x + 0.19, 0.6, 0.6})),
                                   {.edge = 0.2}, diagnostics);
    EXPECT_EQ(expect_sound(mesh), 1u);
    for (const std::string& note : diagnostics.notes())
      left_out += note.find("1 piece of the size of a cube or two") != note.npos ? 1 : 0;
  }
  EXPECT_GT(left_out, 0u);
  // The only material stays.
  EXPECT_EQ(filled(box_surface({0.1, 0.1, 0.1}, {0.3, 0.3, 0.3}), {.edge = 0.16}).hexahedra.size(),
            8u);
}

TEST(FillSurface, FindsTheEdgeForANumberOfCells) {
  const TriangleSurface ball = sphere_surface({3, -2, 1}, 1, 4);
  for (const std::size_t cells : {4000, 30000})
    EXPECT_NEAR(double(filled(ball, {.cells = cells}).hexahedra.size()), double(cells),
                0.01 * double(cells));
}

// A cut opens the surface: both sides of it are closed again.
TEST(FillSurface, CutsOpenTheSurface) {
  Shown shown(filled(sphere_surface({0, 0, 0}, 1, 4), {.edge = 0.13}));
  CellComplex& complex = shown.imported.complex;
  const auto is_below = [&](Index e) {
    double z = 0;
    for (const Index v : complex.vertices_of(e)) z += shown.imported.rest[v][2] / 8;
    return z < 0.05;
  };
  std::vector<Dart> faces;
  for (Index e = 0; e < complex.element_count(); ++e)
    for (int f = 0; f < 6; ++f)
      if (const Index other = complex.neighbour(e, f);
          other != none && is_below(e) && !is_below(other))
        faces.push_back(face_dart(e, f));
  const std::size_t before = shown.surface.triangles.size();
  const TopologyChange change = complex.cut(faces);
  for (const Split& split : change.splits[0])
    shown.imported.rest.push_back(Vec3(shown.imported.rest[split.old_cell]));
  const double volume = enclosed_volume(shown.surface);
  shown.take();
  EXPECT_EQ(expect_manifold(shown.surface), 2u);
  EXPECT_GT(shown.surface.triangles.size(), before + 2 * faces.size());
  EXPECT_NEAR(enclosed_volume(shown.surface), volume, 1e-12 * volume);
}

TEST(FillSurface, RefusesWhatItCannotSee) {
  const TriangleSurface speck = box_surface({0, 0, 0}, {0.1, 0.1, 0.1});
  EXPECT_NE(error_of<InputError>([&] {
              filled(speck, {.edge = 1});
            }).find("no cube of edge 1 m has a corner inside the body of 0.1 x 0.1 x 0.1 m"),
            std::string::npos);
  EXPECT_NE(error_of<InputError>([&] { filled(speck, {}); }).find("give either"),
            std::string::npos);
  EXPECT_NE(
      error_of<InputError>([&] { filled(speck, {.cells = 5, .edge = 1}); }).find("give either"),
      std::string::npos);
  Diagnostics diagnostics;
  std::mt19937 random(1);
  fill_surface(turned(box_surface({0, 0, 0}, {1, 1, 0.03}), random), {.edge = 0.09}, diagnostics);
  ASSERT_EQ(diagnostics.warnings().size(), 1u);
  EXPECT_NE(diagnostics.warnings()[0].find("thinner than that"), std::string::npos);
}

}  // namespace
}  // namespace suture
