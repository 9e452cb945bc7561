// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstring>

#include "kernel/base/error.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "tests/mesh/damaged_files.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/mesh/vtk_files.hpp"

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
  return with_replaced(two_pieces(), old_text, new_text);
}

std::string error_of(const std::string& text) { return read_error("m.vtu", text); }

TEST(Vtu, ReadsArraysOfThePieces) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  const auto read = [&](const std::string& text) {
    return read_mesh(folder.write("m.vtu", text), 1, diagnostics, all_arrays).arrays;
  };
  // Integers are numbers, too; ids are not listed, nor are values of skipped cells.
  const auto arrays = read(replaced("1e5 2e5", "nan 2e5"));
  ASSERT_EQ(arrays.size(), 2u);
  EXPECT_EQ(arrays[0].name, "material <a>");
  EXPECT_EQ(arrays[0].values, (std::vector<double>{4, 5}));
  EXPECT_TRUE(arrays[0].of_elements);
  EXPECT_EQ(arrays[1].name, "E");
  ASSERT_EQ(arrays[1].values.size(), 2u);
  EXPECT_TRUE(std::isnan(arrays[1].values[0]));
  EXPECT_EQ(arrays[1].values[1], 1e5);

  const auto partly = read(replaced("Name=\"E\"", "Name=\"F\""));
  ASSERT_EQ(partly.size(), 3u);
  for (const std::size_t i : {1, 2}) {
    EXPECT_TRUE(partly[i].values.empty());
    EXPECT_EQ(partly[i].unreadable, "it does not appear exactly once in every piece of the file");
  }
  EXPECT_EQ(
      read(replaced("type=\"Float64\" Name=\"E\"", "type=\"String\" Name=\"E\""))[1].unreadable,
      "its type is 'String', not a number");
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

std::string base64(const std::string& bytes) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t b = 0; b < 3; ++b)
      group = group << 8 | (i + b < bytes.size() ? static_cast<unsigned char>(bytes[i + b]) : 0);
    for (std::size_t d = 0; d < 4; ++d)
      text += i + d > bytes.size() ? '=' : digits[group >> (18 - 6 * d) & 63];
  }
  return text;
}

// The header of plain data is encoded with the data or by itself, of four bytes or of eight.
TEST(Vtu, ReadsHeadersThatAreEncodedApart) {
  const std::array<double, 2> values{1e5, 2e5};
  std::string data(sizeof values, '\0');
  std::memcpy(data.data(), values.data(), data.size());
  for (const std::size_t word : {4, 8})
    for (const bool is_apart : {false, true}) {
      std::string header(word, '\0');
      header[0] = static_cast<char>(data.size());
      const std::string encoded = is_apart ? base64(header) + base64(data) : base64(header + data);
      std::string text = replaced("format=\"ascii\">1e5 2e5", "format=\"binary\">" + encoded);
      if (word == 8)
        text = with_replaced(text, "byte_order=", "header_type=\"UInt64\" byte_order=");
      const TemporaryFolder folder;
      Diagnostics diagnostics;
      const auto arrays = read_mesh(folder.write("m.vtu", text), 1, diagnostics, all_arrays).arrays;
      ASSERT_EQ(arrays.size(), 2u);
      ASSERT_FALSE(arrays[1].values.empty()) << arrays[1].unreadable;
      EXPECT_EQ(arrays[1].values[0], 1e5) << word << is_apart;
    }
}

TEST(Vtu, SaysWhatIsWrongAndInWhichLine) {
  EXPECT_EQ(error_of(replaced("UnstructuredGrid", "PolyData")),
            "m.vtu:3: the data set is 'PolyData'; an UnstructuredGrid with hexahedra is expected");
  EXPECT_NE(error_of(replaced("</VTKFile>", "")).find("it is truncated"), std::string::npos);
  EXPECT_EQ(error_of(replaced("NumberOfPoints=\"9\"", "NumberOfPoints=\"9000000000\"")),
            "m.vtu: 9,000,000,000 points or cells are too many for 32-bit numbers");
  EXPECT_NE(error_of(replaced("NumberOfPoints=\"9\"", "NumberOfPoints=\"10\""))
                .find("m.vtu:6: array 'n' has 9"),
            std::string::npos);
  EXPECT_EQ(error_of(replaced("0 1 2 3 4 5 6 7", "0 1 2 3 4 5 6 9")),
            "m.vtu:11: a cell has point 9; the piece has 9 points");
  EXPECT_EQ(error_of(replaced("8 12<", "8 13<")),
            "m.vtu:11: array 'connectivity' has 12 numbers, expected 13: the file is truncated or "
            "damaged");
  EXPECT_EQ(error_of(replaced("8 12<", "8 7<")),
            "m.vtu:12: the offsets of the cells are not ascending");
  EXPECT_EQ(error_of(replaced(">12 10<", ">12 266<")), "m.vtu:13: cell type 266 is unknown");
  EXPECT_EQ(error_of(replaced("1 1 1 1 0", "1 1 1 1 nan")),
            "m.vtu:10: number of an array is 'nan', which is not finite");
  EXPECT_EQ(error_of(replaced("\"ascii\">8", "\"asci\">8")),
            "m.vtu:12: format 'asci' of an array is unknown");
}

TEST(Vtu, DoesNotTrustTheHeadersOfCompressedArrays) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  write_mesh(folder / "m.vtu", make_box({.cells = {4, 4, 4}}), diagnostics);
  const std::string good = read_text(folder / "m.vtu");
  // The first array: number of blocks, size of a block, of the last one, and compressed.
  const std::size_t header = good.find('_', good.find("<AppendedData")) + 1;
  const char* messages[] = {"the header of an array is damaged", "",
                            "the header of an array is damaged", "is longer than the file"};
  for (const std::size_t word : {0u, 2u, 3u}) {
    std::string bad = good;
    const std::uint64_t huge = 20'000'000'000;
    std::memcpy(&bad[header + 8 * word], &huge, sizeof huge);
    const std::string error = error_of(bad);
    EXPECT_NE(error.find(messages[word]), std::string::npos) << error;
  }
}

TEST(Vtu, ReportsMalformedXml) {
  const std::string tag = "<DataArray type=\"Int32\" Name=\"material &lt;a&gt;\" format=\"ascii\">";
  EXPECT_EQ(error_of(replaced(tag, tag.substr(1))),
            "m.vtu:7: </DataArray> closes <CellData>: the file is damaged");
  EXPECT_EQ(error_of(replaced(tag, "<DataArrax" + tag.substr(10))),
            "m.vtu:7: <CellData> has an element <DataArrax>, where only <DataArray> is expected: "
            "the file is damaged");
  EXPECT_EQ(error_of(replaced("Name=\"E\"", "Name=E\"")),
            "m.vtu:8: the tag '<DataArray type=\"Float64\" Name=E\" format...' is malformed: "
            "expected <name key=\"value\" ...>");
  EXPECT_EQ(
      error_of(replaced("</PointData>", "")),
      "m.vtu:7: <PointData> has an element <CellData>, where only <DataArray> is expected: the "
      "file is damaged");
  EXPECT_EQ(error_of(replaced("type=\"Int64\"", "type=\"Int46\"")),
            "m.vtu:6: type 'Int46' of an array is unknown");
}

// VTK writes the range of a vector's norm into its array.
TEST(Vtu, ReadsSetsBehindAnArrayWithInformation) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  const std::string key =
      "<InformationKey name=\"L2\"><Value index=\"0\">1</Value></InformationKey>";
  const std::string vectors =
      "<CellData><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 "
      "0" +
      key + "</DataArray>";
  const Mesh mesh =
      read_mesh(folder.write("m.vtu", replaced("<CellData>", vectors)), 1, diagnostics);
  EXPECT_EQ(mesh.element_sets, (Sets{{"material <a> 4", {0}}, {"material <a> 5", {1}}}));
}

TEST(Vtu, WarnsOfSetsThatNotAllPiecesHave) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  const Mesh mesh =
      read_mesh(folder.write("m.vtu", replaced("\"material ", "\"matter ")), 1, diagnostics);
  EXPECT_TRUE(mesh.element_sets.empty());
  ASSERT_GE(diagnostics.warnings().size(), 2u);
  EXPECT_TRUE(diagnostics.warnings()[0].ends_with(
      "array 'material <a>' does not appear exactly once in every piece; it is not read"));
}

// 80 million points at 0, which zlib makes 1,000 times smaller, and whose arrays fit each other.
TEST(Vtu, RefusesCompressedBombsBeforeTheyExpand) {
  constexpr std::uint64_t block = 3 << 18, blocks = 2000;
  std::string bomb =
      "<VTKFile type=\"UnstructuredGrid\" header_type=\"UInt64\" "
      "compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid><Piece NumberOfPoints=\"" +
      std::to_string(blocks * block / 24) +
      "\" NumberOfCells=\"0\"><Points><DataArray type=\"Float64\" Name=\"Points\" "
      "NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/></Points></Piece>\n"
      "</UnstructuredGrid><AppendedData encoding=\"raw\">_";
  const std::string packed = zlib_zeros(block);
  std::vector<std::uint64_t> header(3 + blocks, packed.size());
  header[0] = blocks;
  header[1] = block;
  header[2] = 0;
  bomb.append(reinterpret_cast<const char*>(header.data()), 8 * header.size());
  for (std::uint64_t b = 0; b < blocks; ++b) bomb += packed;
  bomb += "</AppendedData></VTKFile>\n";
  const auto start = std::chrono::steady_clock::now();
  const std::string error = error_of(bomb);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  EXPECT_NE(error.find("numbers, more than expected for a file of"), std::string::npos) << error;
  EXPECT_LT(seconds.count(), 0.2);
}

// The most regular mesh there is stays far below what a bomb expands to.
TEST(Vtu, ReadsWhatCompressesBest) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  Mesh mesh = make_box({.cells = {24, 24, 24}});
  for (int i = 0; i < 20; ++i) mesh.element_sets["empty but one " + std::to_string(i)] = {0};
  write_with_vtk(folder / "m.vtu", mesh, VtkEncoding::lzma);
  EXPECT_EQ(read_mesh(folder / "m.vtu", 1, diagnostics).element_sets, mesh.element_sets);
}

}  // namespace
}  // namespace suture
