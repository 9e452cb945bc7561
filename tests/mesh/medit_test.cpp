// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "kernel/base/error.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "tests/mesh/damaged_files.hpp"
#include "tests/mesh/temporary_folder.hpp"

namespace suture {
namespace {

// Two cubes along x; vertices counterclockwise below, then above, as in Medit.
const std::string two_cubes = R"(MeshVersionFormatted 2  # a comment
Dimension
3
Vertices 12
0 0 0 0
1 0 0 7
1 1 0 7
0 1 0 0
0 0 1 0
1 0 1 7
1 1 1 7
0 1 1 0
2 0 0 0
2 1 0 0
2 0 1e0 0
+2 1.0 1 0
Triangles
1
1 2 3 0
Quadrilaterals 2
1 4 8 5 3
2 3 7 6 0
Hexahedra
2
1 2 3 4 5 6 7 8 1
2 9 10 3 6 11 12 7 -2
RequiredVertices 2 1 2
End
)";

std::string changed_cubes(const std::string& old_text, const std::string& new_text) {
  return with_replaced(two_cubes, old_text, new_text);
}

std::string medit_error_of(const std::string& text) { return read_error("m.mesh", text); }

TEST(Medit, ReadsHexahedraInOrderXAndRefsAsSets) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  const Mesh mesh = read_mesh(folder.write("m.mesh", two_cubes), 0.5, diagnostics);
  ASSERT_EQ(mesh.points.size(), 12u);
  EXPECT_EQ(mesh.points[11], (Vec3{1, 0.5, 0.5}));
  ASSERT_EQ(mesh.hexahedra.size(), 2u);
  EXPECT_EQ(mesh.hexahedra[0], (Hexahedron{0, 1, 3, 2, 4, 5, 7, 6}));
  EXPECT_EQ(mesh.hexahedra[1], (Hexahedron{1, 8, 2, 9, 5, 10, 6, 11}));
  EXPECT_EQ(mesh.point_sets, (std::map<std::string, std::vector<Index>>{
                                 {"ref 7", {1, 2, 5, 6}}, {"quads ref 3", {0, 3, 4, 7}}}));
  EXPECT_EQ(mesh.element_sets,
            (std::map<std::string, std::vector<Index>>{{"ref 1", {0}}, {"ref -2", {1}}}));
  EXPECT_EQ(mesh.element_ids, (std::vector<std::uint64_t>{1, 2}));
  EXPECT_EQ(mesh.skipped_cells,
            (std::map<std::string, std::size_t>{{"quadrilaterals", 2}, {"triangles", 1}}));
  ASSERT_EQ(diagnostics.warnings().size(), 1u);
  EXPECT_NE(diagnostics.warnings()[0].find("skipped 2 quadrilaterals, 1 triangles"),
            std::string::npos);
}

TEST(Medit, SaysWhatIsWrongAndInWhichLine) {
  EXPECT_EQ(medit_error_of(""), "m.mesh: the file is empty");
  EXPECT_EQ(medit_error_of(changed_cubes("Version", "Edition")).substr(0, 9), "m.mesh:1:");
  EXPECT_EQ(medit_error_of(changed_cubes("Formatted 2", "Formatted 9")),
            "m.mesh:1: Medit version 9; supported versions are 1 to 4");
  EXPECT_EQ(medit_error_of(changed_cubes("\n3\n", "\n2\n")), "m.mesh:3: dimension 2; expected 3");
  EXPECT_EQ(medit_error_of(changed_cubes("1 1 1 7", "1 1 x 7")),
            "m.mesh:11: expected a number (coordinate), found 'x'");
  EXPECT_EQ(medit_error_of(changed_cubes("1 1 1 7", "1 1 nan 7")),
            "m.mesh:11: coordinate is 'nan', which is not finite");
  EXPECT_EQ(medit_error_of(changed_cubes("1 1 1 7", "1 1 1e999 7")),
            "m.mesh:11: coordinate is '1e999', which is not finite");
  EXPECT_EQ(medit_error_of(changed_cubes("2 9 10", "2 13 10")),
            "m.mesh:26: hexahedron 2 has vertex 13; the vertices are numbered 1 to 12");
  EXPECT_EQ(medit_error_of(changed_cubes("1 4 8 5", "1 4 8 0")),
            "m.mesh:21: quadrilateral 1 has vertex 0; the vertices are numbered 1 to 12");
  EXPECT_EQ(medit_error_of(changed_cubes("2 9 10", "2 9.5 10")),
            "m.mesh:26: expected an integer (number of a vertex), found '9.5'");
  EXPECT_EQ(medit_error_of(changed_cubes("2 9 10", "2 99999999999 10")),
            "m.mesh:26: number of a vertex '99999999999' is out of range");
  EXPECT_NE(medit_error_of(changed_cubes("Hexahedra\n2", "Hexahedra\n1"))
                .find("m.mesh:26: expected a keyword"),
            std::string::npos);
}

TEST(Medit, DoesNotTrustCounts) {
  EXPECT_NE(medit_error_of(changed_cubes("Vertices 12", "Vertices 4000000000000000000"))
                .find("m.mesh:4: 4,000,000,000,000,000,000 vertices are declared"),
            std::string::npos);
  EXPECT_NE(medit_error_of(changed_cubes("Hexahedra\n2", "Hexahedra\n3")).find("m.mesh:27:"),
            std::string::npos);
}

TEST(Medit, AFileWithoutHexahedraSaysWhatItHolds) {
  EXPECT_EQ(
      medit_error_of(
          "MeshVersionFormatted 1 Dimension 3 Vertices 1 0 0 0 0 Tetrahedra 1 1 1 1 1 0 End"),
      "m.mesh: no hexahedra; the file contains 1 points, 1 tetrahedra. Mesh the body with 8-node "
      "hexahedra, or let it be filled with them: with \"cells\" beside \"file\" in a scene, "
      "and in 'suture mesh fill', other solid cells give its shape");
}

TEST(Medit, AMissingEndIsAWarning) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  const std::string text = changed_cubes("End\n", "");
  EXPECT_EQ(read_mesh(folder.write("m.mesh", text), 1, diagnostics).hexahedra.size(), 2u);
  ASSERT_EQ(diagnostics.warnings().size(), 2u);
  EXPECT_NE(diagnostics.warnings()[0].find("may be truncated"), std::string::npos);
}

TEST(ReadMesh, NamesTheNearestFile) {
  const TemporaryFolder folder;
  folder.write("liver.mesh", two_cubes);
  Diagnostics diagnostics;
  try {
    read_mesh(folder / "livre.mesh", 1, diagnostics);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no such file (did you mean 'liver.mesh'?)"),
              std::string::npos);
  }
  EXPECT_THROW(read_mesh(folder.path(), 1, diagnostics), InputError);
}

TEST(ReadMesh, GoesByContentBeforeExtension) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  EXPECT_EQ(read_mesh(folder.write("m.msh", two_cubes), 1, diagnostics).hexahedra.size(), 2u);
  EXPECT_THROW(read_mesh(folder.write("m.obj", "v 0 0 0"), 1, diagnostics), InputError);
  EXPECT_THROW(read_mesh(folder.write("m.mesh", two_cubes), 0, diagnostics), InputError);
}

}  // namespace
}  // namespace suture
