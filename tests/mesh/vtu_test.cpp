// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cstring>

#include "kernel/base/error.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "tests/mesh/temporary_folder.hpp"

namespace suture {
namespace {

using Sets = std::map<std::string, std::vector<Index>>;

std::string piece(double shift, int material) {
  const std::string z = std::to_string(shift), m = std::to_string(material);
  return R"(<Piece NumberOfPoints="9" NumberOfCells="2">
<PointData GlobalIds="n"><DataArray type="Int64" Name="n" format="ascii">1 2 3 4 5 6 7 8 )" +
         m +
         R"(</DataArray></PointData>
<CellData><DataArray type="Int32" Name="material &lt;a&gt;" format="ascii">)" +
         m + R"( 9</DataArray>
<DataArray type="Float64" Name="E" format="ascii">1e5 2e5</DataArray></CellData>
<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">
0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1 0 0 )" +
         z + R"(</DataArray></Points>
<Cells><DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 3 4 5 6 7 0 1 2 8</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">8 12</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">12 10</DataArray></Cells>
</Piece>
)";
}

std::string two_pieces() {
  return "<?xml version=\"1.0\"?>\n<!-- a > comment -->\n"
         "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order='LittleEndian'>\n"
         "<UnstructuredGrid>\n" +
         piece(2, 4) + piece(3, 5) + "</UnstructuredGrid>\n</VTKFile>\n";
}

std::string replaced(const std::string& old_text, const std::string& new_text) {
  std::string text = two_pieces();
  const std::size_t at = text.find(old_text);
  EXPECT_NE(at, text.npos) << old_text;
  return text.replace(at, old_text.size(), new_text);
}

std::string error_of(const std::string& text) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  try {
    read_mesh(folder.write("m.vtu", text), 1, diagnostics);
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find("m.vtu"));
  }
  return "no error";
}

TEST(Vtu, JoinsPieces) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  const Mesh mesh = read_mesh(folder.write("m.vtu", two_pieces()), 1, diagnostics);
  ASSERT_EQ(mesh.points.size(), 18u);
  EXPECT_EQ(mesh.points[17], (Vec3{0, 0, 3}));
  EXPECT_EQ(mesh.hexahedra,
            (std::vector<Hexahedron>{{0, 1, 3, 2, 4, 5, 7, 6}, {9, 10, 12, 11, 13, 14, 16, 15}}));
  EXPECT_EQ(mesh.element_sets, (Sets{{"material <a> 4", {0}}, {"material <a> 5", {1}}}));
  ASSERT_EQ(mesh.point_ids.size(), 18u);
  EXPECT_EQ(mesh.point_ids[17], 5u);
  EXPECT_EQ(mesh.skipped_cells, (std::map<std::string, std::size_t>{{"tetrahedra", 2}}));
}

TEST(Vtu, SaysWhatIsWrongAndInWhichLine) {
  EXPECT_EQ(error_of(replaced("UnstructuredGrid", "PolyData")),
            "m.vtu:3: the data set is 'PolyData'; an UnstructuredGrid with hexahedra is needed");
  EXPECT_NE(error_of(replaced("</VTKFile>", "")).find("it is truncated"), std::string::npos);
  EXPECT_EQ(error_of(replaced("NumberOfPoints=\"9\"", "NumberOfPoints=\"9000000000\"")),
            "m.vtu: 9,000,000,000 points or cells are more than 32-bit numbers reach");
  EXPECT_NE(error_of(replaced("NumberOfPoints=\"9\"", "NumberOfPoints=\"10\""))
                .find("m.vtu:6: array 'n' has 9"),
            std::string::npos);
  EXPECT_EQ(error_of(replaced("0 1 2 3 4 5 6 7", "0 1 2 3 4 5 6 9")),
            "m.vtu:11: a cell has point 9; the piece has 9 points");
  EXPECT_EQ(error_of(replaced("8 12<", "8 13<")),
            "m.vtu:12: the offsets of the cells do not fit their connectivity");
  EXPECT_EQ(error_of(replaced("1 1 1 1 0", "1 1 1 1 nan")),
            "m.vtu:10: number of an array is 'nan', which is not finite");
  EXPECT_EQ(error_of(replaced("\"ascii\">8", "\"asci\">8")),
            "m.vtu:12: format 'asci' of an array is not known");
}

TEST(Vtu, DoesNotTrustTheHeadersOfCompressedArrays) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  write_mesh(folder / "m.vtu", make_box({.cells = {4, 4, 4}}), diagnostics);
  const std::string good = read_text(folder / "m.vtu");
  // The first array: number of blocks, size of a block, of the last one, and compressed.
  const std::size_t header = good.find('_', good.find("<AppendedData")) + 1;
  const char* messages[] = {"the header of an array is damaged",
                            "more memory than its data can expand to",
                            "more memory than its data can expand to", "is longer than the file"};
  for (std::size_t word = 0; word < 4; ++word) {
    std::string bad = good;
    const std::uint64_t huge = 20'000'000'000;
    std::memcpy(&bad[header + 8 * word], &huge, sizeof huge);
    const std::string error = error_of(bad);
    EXPECT_NE(error.find(messages[word]), std::string::npos) << error;
    EXPECT_EQ(error.find("m.vtu, byte "), 0u) << error;
  }
}

}  // namespace
}  // namespace suture
