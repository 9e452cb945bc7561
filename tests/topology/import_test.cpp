// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/import.hpp"

#include <gtest/gtest.h>

#include "kernel/base/error.hpp"
#include "kernel/topology/ordering.hpp"
#include "kernel/topology/rest_shape.hpp"
#include "tests/topology/meshes.hpp"

namespace suture {
namespace {

using namespace meshes;

Imported import(Mesh mesh, ImportOptions options = {}) {
  Diagnostics diagnostics;
  Imported result = import_mesh(std::move(mesh), options, diagnostics);
  EXPECT_TRUE(diagnostics.warnings().empty()) << diagnostics.warnings()[0];
  return result;
}

/// Imports with exactly one warning, that contains the text.
Imported import_warned(Mesh mesh, const std::string& text, ImportOptions options = {}) {
  Diagnostics diagnostics;
  Imported result = import_mesh(std::move(mesh), options, diagnostics);
  EXPECT_EQ(diagnostics.warnings().size(), 1u);
  for (const std::string& warning : diagnostics.warnings())
    EXPECT_NE(warning.find(text), std::string::npos) << warning;
  return result;
}

template <class Exception>
void expect_refused(Mesh mesh, std::initializer_list<const char*> words,
                    ImportOptions options = {}) {
  Diagnostics diagnostics;
  try {
    import_mesh(std::move(mesh), options, diagnostics);
    ADD_FAILURE() << "accepted";
  } catch (const Exception& error) {
    for (const char* word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << "missing: " << word << "\nin: " << error.what();
  }
}

void expect_maps_are_consistent(const Mesh& mesh, const Imported& in) {
  ASSERT_EQ(in.complex.element_count(), mesh.hexahedra.size());
  ASSERT_EQ(in.rest.size(), in.complex.count(0));
  ASSERT_EQ(in.user_vertex.size(), in.complex.count(0));
  for (Index e = 0; e < in.complex.element_count(); ++e) {
    EXPECT_EQ(in.element_of[in.user_element[e]], e);
    for (int i = 0; i < 8; ++i) {
      const Index v = in.complex.vertices_of(e)[i];
      EXPECT_EQ(in.user_vertex[v], mesh.hexahedra[in.user_element[e]][i]);
      EXPECT_EQ(in.rest[v], mesh.points[in.user_vertex[v]]);
    }
  }
  std::size_t listed = 0;
  for (Index p = 0; p < mesh.points.size(); ++p)
    for (const Index v : in.vertices_of_point(p)) {
      EXPECT_EQ(in.user_vertex[v], p);
      ++listed;
    }
  EXPECT_EQ(listed, in.complex.count(0));
}

TEST(Import, KeepsANaturalOrder) {
  const Mesh mesh = grid(6, 5, 4);
  const Imported in = import(mesh);
  expect_maps_are_consistent(mesh, in);
  EXPECT_TRUE(in.user_element.list().empty());
}

TEST(Import, KeepsTheOrderOfGridsOfAnySize) {
  for (const Mesh& mesh :
       {grid(60, 12, 10), grid(12, 10, 60), grid(18, 17, 16), grid(40, 10, 10)}) {
    const Imported in = import(mesh);
    for (Index e = 0; e < in.complex.element_count(); ++e) ASSERT_EQ(in.user_element[e], e);
  }
}

TEST(Import, OrdersShuffledElementsAlongACurve) {
  std::mt19937 random(3);
  const Mesh mesh = shuffled(grid(20, 20, 20), random);
  EXPECT_FALSE(is_local(mesh.hexahedra, Index(mesh.points.size())));
  const Imported in = import(mesh);
  expect_maps_are_consistent(mesh, in);
  in.complex.validate();
  EXPECT_TRUE(is_local(in.complex.vertices(), in.complex.count(0)));
}

TEST(Import, WithoutRenumberingKeepsTheOrderOfPointsAndElements) {
  std::mt19937 random(4);
  const Mesh mesh = shuffled(grid(20, 20, 20), random);
  const Imported in = import(mesh, {.renumber = false});
  expect_maps_are_consistent(mesh, in);
  EXPECT_TRUE(in.user_element.list().empty());
  EXPECT_TRUE(std::ranges::is_sorted(in.user_vertex));
}

TEST(Import, DropsUnusedPoints) {
  Mesh mesh = two_cubes();
  mesh.points.insert(mesh.points.begin(), {9, 9, std::nan("")});
  mesh.points.push_back({8, 8, 8});
  for (Hexahedron& h : mesh.hexahedra)
    for (Index& v : h) ++v;
  const Imported in = import_warned(mesh, "2 points not used by any hexahedron");
  expect_maps_are_consistent(mesh, in);
  EXPECT_TRUE(in.vertices_of_point(0).empty());
  EXPECT_TRUE(in.vertices_of_point(4711).empty());
}

TEST(Import, TurnsMirroredElementsRound) {
  Mesh mesh = grid(3, 2, 1);
  mirror(mesh.hexahedra[1]);
  mirror(mesh.hexahedra[4]);
  const Imported in = import_warned(mesh, "2 elements with mirrored node numbering");
  in.complex.validate();
  Index islands = 0;
  in.complex.islands(&islands);
  EXPECT_EQ(islands, 1u);
}

TEST(Import, TurnsAWhollyMirroredMeshRound) {
  Mesh mesh = grid(3, 3, 3);
  for (Vec3& x : mesh.points) x[2] = -x[2];
  import_warned(mesh, "27 elements with mirrored node numbering").complex.validate();
}

TEST(Import, SplitsNonManifoldCellsOrRefusesThem) {
  // Vertex: cubes on a diagonal. Edge: two columns between two plates.
  const Mesh corner = voxels(2, 2, 2, [](int x, int y, int z) { return x == y && y == z; });
  const Imported in = import_warned(corner, "non-manifold at 1 vertex and 0 edges");
  expect_maps_are_consistent(corner, in);
  EXPECT_EQ(in.vertices_of_point(corner.hexahedra[0][7]).size(), 2u);
  expect_refused<TopologyError>(corner, {"non-manifold at 1 vertex", "points 7"},
                                {.non_manifold = ImportOptions::NonManifold::refuse});

  const Mesh columns = voxels(3, 3, 3, [](int x, int y, int z) {
    return z != 1 || (x == 0 && y == 0) || (x == 1 && y == 1);
  });
  import_warned(columns, "non-manifold at 0 vertices and 1 edge");
  expect_refused<TopologyError>(columns, {"non-manifold at 0 vertices and 1 edge", "edges "},
                                {.non_manifold = ImportOptions::NonManifold::refuse});
}

TEST(Import, RefusesEveryDefectWithElementAndReason) {
  Mesh mesh = two_cubes();
  mesh.hexahedra[1][5] = 12;
  mesh.element_ids = {100, 200};
  expect_refused<TopologyError>(mesh, {"voxels", "does not exist", "element 200 uses point 12"});

  mesh = two_cubes();
  mesh.point_ids = {50, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60, 61};
  mesh.hexahedra[1][7] = mesh.hexahedra[1][6];
  expect_refused<TopologyError>(
      mesh, {"the same point twice", "\"bad_elements\": \"drop\"", "element 1 uses point 5"});

  mesh = two_cubes();
  mesh.hexahedra.push_back(mesh.hexahedra[1]);
  for (int i : {1, 3, 5, 7}) {
    mesh.points.push_back(mesh.points[mesh.hexahedra[1][i]]);
    mesh.points.back()[0] += 0.5;
    mesh.hexahedra[2][i] = Index(mesh.points.size() - 1);
  }
  expect_refused<TopologyError>(mesh, {"in three elements", "elements 0, 1 and 2"});

  // Two elements on the same side of a face: the second overlaps the first.
  mesh = two_cubes();
  for (int i : {1, 3, 5, 7}) {
    mesh.hexahedra[1][i] = Index(mesh.points.size());
    mesh.points.push_back(mesh.points[mesh.hexahedra[0][i - 1]]);
  }
  for (int i : {0, 2, 4, 6}) std::swap(mesh.hexahedra[1][i], mesh.hexahedra[1][i + 1]);
  expect_refused<TopologyError>(mesh, {"same side", "elements 0 and 1"});

  mesh = two_cubes();
  std::swap(mesh.hexahedra[1][0], mesh.hexahedra[1][2]);
  expect_refused<TopologyError>(mesh, {"a different cyclic order", "elements 0 and 1"});

  mesh = two_cubes();
  mesh.points[3][1] = std::nan("");
  expect_refused<InputError>(mesh, {"not finite", "1 point", ": 3"});
}

TEST(Import, RefusesMeshesWithoutHexahedraAndSaysWhatTheyHold) {
  Mesh mesh;
  mesh.source = "liver.vtk";
  mesh.points.push_back({0, 0, 0});
  mesh.skipped_cells["tetrahedron"] = 512;
  expect_refused<InputError>(mesh, {"'liver.vtk' has no hexahedra", "512", "tetrahedron"});
}

TEST(Import, ListsAllInvertedElements) {
  Mesh mesh = grid(30, 1, 1);
  // The far upper corner of every second element pushed through the opposite side of
  // its top: a corner Jacobian turns negative, the Gauss points stay positive.
  std::string expected;
  for (Index e = 0; e < 30; e += 2) {
    mesh.points[mesh.hexahedra[e][4]] = {e + 0.4, 0.72, 1.0};
    expected += (e ? ", " : "") + std::to_string(e);
  }
  expect_refused<TopologyError>(mesh, {"corner Jacobian", expected.c_str(), "allow_inverted_rest",
                                       "\"bad_elements\": \"drop\""});
}

TEST(Import, AdmitsInvertedCornersIfTheGaussPointsArePositive) {
  Mesh mesh = two_cubes();
  mesh.points[mesh.hexahedra[0][0]] = {0.45, 0.45, 0.45};
  const Corners x = [&] {
    Corners c;
    for (int i = 0; i < 8; ++i) c[i] = mesh.points[mesh.hexahedra[0][i]];
    return c;
  }();
  ASSERT_LT(std::ranges::min(corner_jacobians(x)), 0);
  ASSERT_GT(std::ranges::min(gauss_jacobians(x)), 0);
  expect_refused<TopologyError>(mesh, {"1 element with a corner Jacobian", ": 0."});
  import_warned(mesh, "accepted because of \"allow_inverted_rest\"", {.allow_inverted_rest = true});

  mesh.points[mesh.hexahedra[0][0]] = {0.95, 0.95, 0.95};
  expect_refused<TopologyError>(mesh, {"at a corner and at a Gauss point"},
                                {.allow_inverted_rest = true});
}

}  // namespace
}  // namespace suture
