// SPDX-License-Identifier: GPL-3.0-or-later
//
// Meshes whose parts have nodes in one place that are not joined.
#include <gtest/gtest.h>

#include "kernel/base/vec3.hpp"
#include "kernel/build/built_scene.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "kernel/scene/scene_reader.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/run/host.hpp"

namespace suture::test::unjoined_nodes_test {
namespace {

/// Builds a scene of two boxes of 2 x 2 x 2 elements that touch along a side; `keys`: further keys
/// of /mesh and of the scene.
struct Built {
  explicit Built(const std::string& keys_of_mesh, const std::string& keys = "") {
    Mesh mesh = make_box({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {1, 1, 1}});
    const auto points = static_cast<Index>(mesh.points.size());
    const std::vector<Hexahedron> hexahedra = mesh.hexahedra;
    for (Index p = 0; p < points; ++p) mesh.points.push_back(plus(mesh.points[p], {1, 0, 0}));
    for (Hexahedron nodes : hexahedra) {
      for (Index& node : nodes) node += points;
      mesh.hexahedra.push_back(nodes);
    }
    mesh.point_sets.clear();
    const TemporaryFolder folder;
    write_mesh(folder / "m.vtu", mesh, diagnostics);
    const auto file = folder.write(
        "s.json",
        R"({"suture": 2, "mesh": {"file": "m.vtu")" + keys_of_mesh +
            R"(}, "models": [{"model": "neo-hookean", "parameters": {"E": 1, "nu": 0, "rho": 1}}],
        "solver": {"end": 1}, "output": false)" +
            keys + "}");
    BuiltScene built(read_scene(file, {}, host(), diagnostics), diagnostics);
    built.body().complex().islands(&islands);
  }

  Diagnostics diagnostics;
  Index islands = 0;
};

TEST(UnjoinedNodes, AreAnnounced) {
  const Built built("");
  EXPECT_EQ(built.islands, 2u);
  ASSERT_EQ(built.diagnostics.warnings().size(), 1u);
  EXPECT_NE(built.diagnostics.warnings()[0].find("2 islands with 9 pairs of nodes in one place"),
            std::string::npos)
      << built.diagnostics.warnings()[0];
}

TEST(UnjoinedNodes, AreJoinedIfTheSceneSaysSo) {
  const Built built(R"(, "merge": 1e-6)");
  EXPECT_EQ(built.islands, 1u);
  EXPECT_TRUE(built.diagnostics.warnings().empty());
  ASSERT_FALSE(built.diagnostics.notes().empty());
  EXPECT_NE(built.diagnostics.notes()[0].find("merged 9 nodes"), std::string::npos);
}

// Pieces that touch may lie side by side.
TEST(UnjoinedNodes, OfPiecesThatTouchAreMeant) {
  EXPECT_TRUE(Built("", R"(, "contact": {"pieces": true})").diagnostics.warnings().empty());
}

}  // namespace
}  // namespace suture::test::unjoined_nodes_test
