// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "kernel/base/error.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "tests/mesh/damaged_files.hpp"
#include "tests/mesh/temporary_folder.hpp"

namespace suture {
namespace {

using Sets = std::map<std::string, std::vector<Index>>;

const std::string cells_of_version_3 =
    "CELLS 3 23\n8 0 1 2 3 4 5 6 7\n4 0 1 2 5\n8 0 1 3 2 4 5 7 6\n";
const std::string cells_of_version_5 =
    "CELLS 4 20\nOFFSETS vtktypeint64\n0 8 12 20\nCONNECTIVITY vtktypeint64\n"
    "0 1 2 3 4 5 6 7\n0 1 2 5\n0 1 3 2 4 5 7 6\n";

// A hexahedron, a tetrahedron and a voxel on the corners of a cube.
std::string cube_text(const std::string& version, const std::string& cells) {
  return "# vtk DataFile Version " + version +
         "\na cube\nASCII\nDATASET UNSTRUCTURED_GRID\n"
         "POINTS 8 float\n0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\n\n" +
         cells +
         "CELL_TYPES 3\n12 10 11\n"
         "CELL_DATA 3\nSCALARS material int 1\nLOOKUP_TABLE default\n5 6 7\n"
         "METADATA\nINFORMATION 0\n\n"
         "FIELD FieldData 2\nof%20both 1 3 unsigned_char\n0 0 1\nstress 6 3 double\n"
         "1 2 3 4 5 6 1 2 3 4 5 6 1 2 3 4 5 6\n"
         "POINT_DATA 8\nVECTORS u float\n0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\n"
         "GLOBAL_IDS ids vtkIdType\n10 11 12 13 14 15 16 17\n";
}

Mesh read(const std::string& text) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  return read_mesh(folder.write("m.vtk", text), 1, diagnostics);
}

std::string vtk_error_of(const std::string& text) { return read_error("m.vtk", text); }

std::string changed_cube(const std::string& old_text, const std::string& new_text) {
  return with_replaced(cube_text("3.0", cells_of_version_3), old_text, new_text);
}

TEST(VtkLegacy, ReadsArraysOfTheHexahedra) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  const auto read = [&](const std::string& text) {
    return read_mesh(folder.write("m.vtk", text), 1, diagnostics, all_arrays).arrays;
  };
  const auto arrays = read(changed_cube("1 2 3 4 5 6 1 2", "1 2 3 4 5 6 nan 2"));
  ASSERT_EQ(arrays.size(), 3u);  // flags are a set, ids are ids
  EXPECT_EQ(arrays[0].name, "material");
  EXPECT_EQ(arrays[0].values, (std::vector<double>{5, 7}));
  EXPECT_EQ(arrays[1].name, "stress");
  EXPECT_EQ(arrays[1].components, 6u);
  EXPECT_EQ(arrays[1].values, (std::vector<double>{1, 2, 3, 4, 5, 6, 1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(arrays[2].name, "u");
  EXPECT_FALSE(arrays[2].of_elements);
  EXPECT_EQ(arrays[2].values.size(), 24u);

  const auto twice = read(changed_cube("stress 6", "material 6"));
  EXPECT_EQ(twice[0].unreadable, "the file has two arrays of this name");
}

TEST(VtkLegacy, ReadsHexahedraVoxelsAndLabels) {
  for (const std::string& text :
       {cube_text("3.0", cells_of_version_3), cube_text("5.1", cells_of_version_5)}) {
    const Mesh mesh = read(text);
    ASSERT_EQ(mesh.points.size(), 8u);
    EXPECT_EQ(mesh.points[6], (Vec3{1, 1, 1}));
    EXPECT_EQ(mesh.hexahedra,
              (std::vector<Hexahedron>{{0, 1, 3, 2, 4, 5, 7, 6}, {0, 1, 3, 2, 4, 5, 7, 6}}));
    EXPECT_EQ(mesh.element_sets,
              (Sets{{"material 5", {0}}, {"material 7", {1}}, {"of both", {1}}}));
    EXPECT_EQ(mesh.point_ids, (std::vector<std::uint64_t>{10, 11, 12, 13, 14, 15, 16, 17}));
    EXPECT_EQ(mesh.skipped_cells, (std::map<std::string, std::size_t>{{"tetrahedra", 1}}));
  }
}

TEST(VtkLegacy, SaysWhatIsWrongAndInWhichLine) {
  EXPECT_EQ(vtk_error_of("nothing of the kind"),
            "m.vtk:1: a legacy VTK file begins with '# vtk DataFile Version', found 'nothing of "
            "the kind'");
  EXPECT_EQ(
      vtk_error_of(changed_cube("UNSTRUCTURED_GRID", "POLYDATA")),
      "m.vtk:4: the data set is 'POLYDATA', a surface; expected an UNSTRUCTURED_GRID with "
      "hexahedra. \"surface\" in /mesh of a scene fills a closed surface, saved as .vtp, .stl, "
      ".obj, .off or .ply");
  EXPECT_EQ(vtk_error_of(changed_cube("ASCII", "ASCCI")),
            "m.vtk:3: expected ASCII or BINARY, found 'ascci'");
  EXPECT_EQ(vtk_error_of(changed_cube("0 1 1 1 1 0", "0 1 1 nan 1 0")),
            "m.vtk:6: coordinate is 'nan', which is not finite");
  EXPECT_EQ(vtk_error_of(changed_cube("4 5 7 6", "4 5 7 8")),
            "m.vtk:11: cell 2 has point 8; the points are numbered 0 to 7");
  EXPECT_EQ(vtk_error_of(changed_cube("4 0 1 2 5", "4000 0 1 2 5")),
            "m.vtk:10: cell 1 has 4000 points, more than the size of CELLS allows");
  EXPECT_EQ(vtk_error_of(changed_cube("CELL_TYPES 3", "CELL_TYPES 4")),
            "m.vtk:12: 4 cell types for 3 cells");
  EXPECT_EQ(vtk_error_of(changed_cube("12 10 11", "12 10 25")).substr(0, 27),
            "m.vtk: cell 2: hexahedra wi");
  EXPECT_EQ(vtk_error_of(changed_cube("CELL_DATA 3", "CELL_DATA 2")),
            "m.vtk:14: 2 values for 3 cells");
  EXPECT_NE(vtk_error_of(changed_cube("POINTS 8", "POINTS 800000000000")).find("m.vtk"),
            std::string::npos);
  EXPECT_NE(vtk_error_of(changed_cube("CELLS 3 23", "CELLS 3 2300000000000")).find("are declared"),
            std::string::npos);
}

std::vector<std::string> warnings_of(const std::string& text) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  read_mesh(folder.write("m.vtk", text), 1, diagnostics);
  return diagnostics.warnings();
}

// Sets behind a damaged or missing array must not get lost in silence.
TEST(VtkLegacy, ReportsArraysThatAreAnnouncedAndNotThere) {
  const std::string whole = cube_text("3.0", cells_of_version_3);
  const auto until = [&](const std::string& word) { return whole.substr(0, whole.find(word)); };
  EXPECT_EQ(vtk_error_of(until("nsigned_char")),
            "m.vtk:22: type of numbers 'u' is unknown: the file is truncated");
  EXPECT_EQ(vtk_error_of(changed_cube("unsigned_char", "unsigned_chas")),
            "m.vtk:22: type of numbers 'unsigned_chas' is unknown");
  EXPECT_EQ(vtk_error_of(until("nt 1\n")),
            "m.vtk:15: type of numbers 'i' is unknown: the file is truncated");
  EXPECT_EQ(vtk_error_of(until("stress")),
            "m.vtk:24: the file ends where name of an array is expected: it is truncated");
  const std::vector<std::string> cut_off = warnings_of(until("VECTORS"));
  ASSERT_EQ(cut_off.size(), 2u);
  EXPECT_TRUE(cut_off[0].ends_with("no array follows POINT_DATA 8; the file may be truncated"));
  const std::vector<std::string> lengths = warnings_of(changed_cube("both 1 3", "both 3 1"));
  EXPECT_TRUE(lengths[0].ends_with("array 'of both' has 1 values for 3 cells; it is not read"));
}

TEST(VtkLegacy, WarnsOfArraysBehindOneOfStrings) {
  const std::vector<std::string> warnings = warnings_of(changed_cube("unsigned_char", "string"));
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_TRUE(warnings[0].ends_with(
      "array 'of both' has the type 'string'; neither it nor the following arrays are read"));
}

TEST(VtkLegacy, TetrahedraOfEightNodesAreHexahedraWithAWarning) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  const Mesh mesh =
      read_mesh(folder.write("m.vtk", changed_cube("12 10 11", "10 10 11")), 1, diagnostics);
  EXPECT_EQ(mesh.hexahedra.size(), 2u);
  ASSERT_EQ(diagnostics.warnings().size(), 2u);
  EXPECT_NE(diagnostics.warnings()[0].find("1 cells of VTK type 10 (tetrahedron) have 8 nodes"),
            std::string::npos);
}

}  // namespace
}  // namespace suture
