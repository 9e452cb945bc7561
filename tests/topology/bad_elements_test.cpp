// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/topology/bad_elements.hpp"

#include <gtest/gtest.h>

#include "kernel/base/error.hpp"
#include "kernel/topology/import.hpp"
#include "kernel/topology/rest_shape.hpp"
#include "tests/topology/meshes.hpp"

namespace suture {
namespace {

using namespace meshes;

std::vector<std::string> warnings_of_dropping(Mesh& mesh, bool allow_inverted_rest = false) {
  Diagnostics diagnostics;
  drop_bad_elements(mesh, allow_inverted_rest, diagnostics);
  return diagnostics.warnings();
}

/// A row of cubes; the outer corner of the first one moved along its diagonal.
Mesh dented_row(int cubes, double dent) {
  Mesh mesh = grid(cubes, 1, 1);
  mesh.points[mesh.hexahedra[0][0]] = {dent, dent, dent};
  return mesh;
}

TEST(BadElements, LeaveTheOthersTheirNumbersAndSets) {
  Mesh mesh = dented_row(4, 0.95);
  mesh.element_sets = {{"left", {0, 1}}, {"first", {0}}, {"right", {2, 3}}};
  mesh.arrays = {{"fibre", true, 2, {0, 0, 1, 10, 2, 20, 3, 30}, {}},
                 {"u", false, 1, std::vector<double>(mesh.points.size()), {}}};
  const Hexahedron first = mesh.hexahedra[0], last = mesh.hexahedra[3];
  const auto warnings = warnings_of_dropping(mesh);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0],
            "mesh 'voxels' has 1 bad element of 4, left out: 1 (0) with a corner Jacobian <= 0");
  EXPECT_EQ(mesh.element_ids, (std::vector<std::uint64_t>{1, 2, 3}));
  EXPECT_EQ(mesh.hexahedra.size(), 3u);
  EXPECT_EQ(mesh.hexahedra[2], last);
  EXPECT_EQ(mesh.arrays[0].values, (std::vector<double>{1, 10, 2, 20, 3, 30}));
  EXPECT_EQ(mesh.arrays[1].values.size(), mesh.points.size());
  EXPECT_EQ(mesh.element_sets["left"], std::vector<Index>{0});
  EXPECT_TRUE(mesh.element_sets["first"].empty());
  EXPECT_EQ(mesh.element_sets["right"], (std::vector<Index>{1, 2}));

  Diagnostics diagnostics;
  const Imported in = import_mesh(mesh, {}, diagnostics);
  EXPECT_EQ(in.complex.count(0), 16u);
  EXPECT_TRUE(in.vertices_of_point(first[0]).empty());
}

TEST(BadElements, KeepTheNumbersOfTheFile) {
  Mesh mesh = grid(2, 2, 1);
  mesh.element_ids = {70, 50, 90, 60};
  mesh.hexahedra[2][7] = mesh.hexahedra[2][6];
  const auto warnings = warnings_of_dropping(mesh);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("1 (90) with the same point twice"), std::string::npos) << warnings[0];
  EXPECT_EQ(mesh.element_ids, (std::vector<std::uint64_t>{70, 50, 60}));
}

TEST(BadElements, IncludeThoseThatAreWhollyInsideOut) {
  // The second of three cubes is pulled through itself: its sides x = 1 and x = 2 change places.
  Mesh mesh = grid(3, 1, 1);
  for (Vec3& point : mesh.points) point[0] = point[0] == 1 ? 2.2 : point[0] == 2 ? 1.8 : point[0];
  Mesh mirrored = mesh;
  for (Hexahedron& nodes : mirrored.hexahedra) mirror(nodes);
  for (Mesh* each : {&mesh, &mirrored}) {
    Diagnostics diagnostics;
    EXPECT_THROW(import_mesh(*each, {}, diagnostics), TopologyError);
    const auto warnings = warnings_of_dropping(*each);
    ASSERT_EQ(warnings.size(), 2u);
    EXPECT_NE(warnings[0].find("1 (1) inside out"), std::string::npos) << warnings[0];
    EXPECT_EQ(each->element_ids, (std::vector<std::uint64_t>{0, 2}));
    EXPECT_NO_THROW(import_mesh(*each, {}, diagnostics));
  }
  // A sound element that is only numbered as its mirror image stays.
  Mesh sound = grid(3, 1, 1);
  mirror(sound.hexahedra[1]);
  EXPECT_TRUE(warnings_of_dropping(sound).empty());
}

TEST(BadElements, AreFewerIfInvertedCornersAreAllowed) {
  Mesh mesh = dented_row(2, 0.45);  // its Gauss points are sound
  EXPECT_TRUE(warnings_of_dropping(mesh, true).empty());
  EXPECT_TRUE(mesh.element_ids.empty());
  EXPECT_EQ(warnings_of_dropping(mesh).size(), 1u);
  Mesh worse = dented_row(2, 0.95);
  EXPECT_EQ(warnings_of_dropping(worse, true).size(), 1u);
  EXPECT_EQ(worse.hexahedra.size(), 1u);
}

TEST(BadElements, WarnIfTheBodyFallsIntoPieces) {
  Mesh row = grid(5, 1, 1);
  for (const Index e : {1, 3}) row.hexahedra[e][7] = row.hexahedra[e][6];
  const auto warnings = warnings_of_dropping(row);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[1].find("falls into 3 separate pieces"), std::string::npos) << warnings[1];

  Mesh already = voxels(5, 1, 1, [](int x, int, int) { return x != 2; });
  already.hexahedra[0][6] = already.hexahedra[0][4];
  EXPECT_EQ(warnings_of_dropping(already).size(), 1u);
}

TEST(BadElements, AreAnErrorIfNoneIsLeft) {
  Mesh mesh = grid(2, 1, 1);
  for (Vec3& point : mesh.points) point[2] = 0;
  try {
    warnings_of_dropping(mesh);
    ADD_FAILURE() << "accepted";
  } catch (const TopologyError& error) {
    EXPECT_NE(std::string(error.what()).find("all 2 are bad"), std::string::npos) << error.what();
  }
}

TEST(BadElements, AreNotThoseWithPointsThatAreNone) {
  Mesh mesh = two_cubes();
  mesh.hexahedra[1][5] = 12;
  mesh.points[0][1] = std::nan("");
  EXPECT_TRUE(warnings_of_dropping(mesh).empty());
  EXPECT_EQ(mesh.hexahedra.size(), 2u);
}

// What is left is what import_mesh() takes, whichever elements are bad.
TEST(BadElements, AreThoseThatTheImportRefuses) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> offset(-0.4, 0.4);
  std::size_t dropped = 0;
  for (const bool allowed : {false, true})
    for (int trial = 0; trial < 20; ++trial) {
      Mesh mesh = grid(5, 4, 3);
      for (Vec3& point : mesh.points)
        for (double& x : point) x += offset(random);
      const ImportOptions options{.allow_inverted_rest = allowed};
      Diagnostics diagnostics;
      Mesh kept = mesh;
      drop_bad_elements(kept, allowed, diagnostics);
      dropped += mesh.hexahedra.size() - kept.hexahedra.size();
      EXPECT_NO_THROW(import_mesh(kept, options, diagnostics));
      if (kept.hexahedra.size() == mesh.hexahedra.size()) continue;
      EXPECT_THROW(import_mesh(mesh, options, diagnostics), TopologyError);
    }
  EXPECT_GT(dropped, 100u);
}

}  // namespace
}  // namespace suture
