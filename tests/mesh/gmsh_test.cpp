// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "tests/mesh/damaged_files.hpp"
#include "tests/mesh/temporary_folder.hpp"

namespace suture {
namespace {

using Sets = std::map<std::string, std::vector<Index>>;

// Files of Gmsh itself: data/two_hexahedra.geo.
std::filesystem::path data(const std::string& name) {
  return std::filesystem::path(SUTURE_TEST_DATA) / name;
}

void expect_two_hexahedra(const Mesh& mesh) {
  ASSERT_EQ(mesh.points.size(), 12u);
  EXPECT_EQ(mesh.points[6], (Vec3{1, 1, 1}));
  EXPECT_EQ(mesh.points[11], (Vec3{0, 1, 2}));
  EXPECT_EQ(mesh.hexahedra,
            (std::vector<Hexahedron>{{0, 1, 3, 2, 4, 5, 7, 6}, {4, 5, 7, 6, 8, 9, 11, 10}}));
  EXPECT_EQ(
      mesh.point_sets,
      (Sets{{"clamped", {0, 1, 2, 3}}, {"physical surface 7", {8, 9, 10, 11}}, {"corner", {2}}}));
  EXPECT_EQ(mesh.element_sets, (Sets{{"soft tissue", {0}}, {"body", {0, 1}}}));
  EXPECT_EQ(mesh.point_ids, (std::vector<std::uint64_t>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}));
  EXPECT_EQ(mesh.skipped_cells,
            (std::map<std::string, std::size_t>{{"quadrilaterals", 2}, {"points as cells", 1}}));
}

TEST(Gmsh, ReadsEveryFormatTheSame) {
  for (const char* name :
       {"two_msh22.msh", "two_msh22_binary.msh", "two_msh41.msh", "two_msh41_binary.msh"}) {
    SCOPED_TRACE(name);
    Diagnostics diagnostics;
    const Mesh mesh = read_mesh(data(name), 1, diagnostics);
    expect_two_hexahedra(mesh);
    // Format 2 repeats the lower element for its second group: one of both stays.
    const bool format_2 = std::string(name).find("22") != std::string::npos;
    EXPECT_EQ(mesh.element_ids,
              format_2 ? (std::vector<std::uint64_t>{4, 6}) : (std::vector<std::uint64_t>{4, 5}));
    EXPECT_EQ(diagnostics.warnings().size(), 1u);
  }
}

// As Gmsh writes format 2 with Mesh.SaveParametric: behind each node the dimension and the tag of
// its entity, and the coordinates on a curve or a surface.
TEST(Gmsh, ReadsParametricNodesOfFormat2) {
  std::string text = read_text(data("two_msh22.msh"));
  const std::size_t begin = text.find("1 0 0 0\n"), end = text.find("$EndNodes");
  std::istringstream lines(text.substr(begin, end - begin));
  std::string nodes, line;
  for (int n = 0; std::getline(lines, line); ++n)
    nodes += line + std::array{" 0 1", " 1 2 0.5", " 2 3 0.25 0.75", " 3 1"}[n % 4] + "\n";
  text.replace(begin, end - begin, nodes);
  text = with_replaced(with_replaced(text, "$Nodes", "$ParametricNodes"), "$EndNodes",
                       "$EndParametricNodes");
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  expect_two_hexahedra(read_mesh(folder.write("m.msh", text), 1, diagnostics));
  EXPECT_NE(read_error("m.msh", with_replaced(text, "1 0 0 0 0 1", "1 0 0 0 4 1"))
                .find("m.msh:13: a node lies on an entity of dimension 4"),
            std::string::npos);
}

std::string gmsh_error_of(const std::string& text) { return read_error("m.msh", text); }

/// The file with a section of values.
std::string with_data(const std::string& section, const std::string& values) {
  return read_text(data("two_msh41.msh")) + "$" + section +
         "\n1\n\"modulus of E\"\n1\n0.5\n3\n0\n" + values + "\n$End" + section + "\n";
}

// Values of cells that are not read are left out; elements 4 and 5 are the hexahedra.
TEST(Gmsh, ReadsDataOfNodesAndElements) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  const auto read = [&](const std::string& text) {
    const Mesh mesh = read_mesh(folder.write("m.msh", text), 1, diagnostics, all_arrays);
    return mesh.arrays.at(0);
  };
  const MeshArray both = read(with_data("ElementData", "1 3\n5 2e6\n2 7\n4 1e6"));
  EXPECT_EQ(both.name, "modulus of E");
  EXPECT_TRUE(both.of_elements);
  EXPECT_EQ(both.values, (std::vector<double>{1e6, 2e6}));
  const MeshArray one = read(with_data("ElementData", "1 1\n5 nan"));
  EXPECT_TRUE(std::isnan(one.values[0]) && std::isnan(one.values[1]));
  const MeshArray nodes = read(with_data("NodeData", "3 1\n12 1 2 3"));
  EXPECT_FALSE(nodes.of_elements);
  EXPECT_EQ(nodes.components, 3u);
  ASSERT_EQ(nodes.values.size(), 36u);
  EXPECT_EQ(nodes.values[35], 3);
  const MeshArray inner = read(with_data("ElementNodeData", "1 1\n4 8 1 2 3 4 5 6 7 8"));
  EXPECT_TRUE(inner.values.empty());
  EXPECT_NE(inner.unreadable.find("the nodes of each element"), std::string::npos);
  const std::string steps = with_data("ElementData", "1 1\n4 1");
  EXPECT_NE(read(steps + steps.substr(steps.find("$ElementData"))).unreadable.find("time steps"),
            std::string::npos);
}

std::string replaced(const std::string& file, const std::string& old_text,
                     const std::string& new_text) {
  return with_replaced(read_text(data(file)), old_text, new_text);
}

TEST(Gmsh, SaysWhatIsWrongAndWhere) {
  const std::string v2 = "two_msh22.msh", v4 = "two_msh41.msh";
  EXPECT_EQ(gmsh_error_of(replaced(v2, "2.2 0 8", "3.7 0 8")).substr(0, 10), "m.msh:2: u");
  EXPECT_EQ(gmsh_error_of(replaced(v4, "4.1 0 8", "4.1 0 4")), "m.msh:2: data size 4; expected 8");
  EXPECT_EQ(gmsh_error_of(replaced(v2, "7 1 1 1", "7 1 1 inf")),
            "m.msh:19: coordinate is 'inf', which is not finite");
  EXPECT_EQ(gmsh_error_of(replaced(v2, "7 1 1 1", "6 1 1 1")),
            "m.msh:24: node 6 is defined twice in the previous section");
  EXPECT_EQ(gmsh_error_of(replaced(v2, "6 5 2 2 2 5", "6 5 2 2 2 99")),
            "m.msh:33: an element has node 99, which is not among the 12 nodes of the file");
  EXPECT_EQ(gmsh_error_of(replaced(v2, "$Nodes\n12", "$Nodes\n11")),
            "m.msh:24: expected $EndNodes, found '12'");
  EXPECT_NE(gmsh_error_of(replaced(v2, "$Elements\n6", "$Elements\n7")).find("m.msh:34: expected"),
            std::string::npos);
  EXPECT_EQ(gmsh_error_of(replaced(v4, "1 2 3 4 5 6 7 8", "1 2 3 4 5 6 7 x")),
            "m.msh:111: expected an integer (node of an element), found 'x'");
  EXPECT_EQ(gmsh_error_of("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"),
            "m.msh:4: section $Nodes is missing: the file is truncated");
  EXPECT_EQ(gmsh_error_of("$NOD\n0\n$ENDNOD\n").substr(0, 9), "m.msh:1: ");
}

TEST(Gmsh, ReportsBlocksAndNamesThatDoNotFit) {
  std::string text = read_text(data("two_msh41.msh"));
  const std::size_t nodes = text.find("$Nodes\n") + 7, end = text.find(' ', nodes);
  text.replace(end, text.find(' ', end + 1) - end, " 13");
  EXPECT_NE(gmsh_error_of(text).find("13 nodes are declared, but the blocks contain 12"),
            std::string::npos)
      << gmsh_error_of(text);
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  text = replaced("two_msh41.msh", "$PhysicalNames\n4\n", "$PhysicalNames\n5\n3 7 \"bone\"\n");
  read_mesh(folder.write("m.msh", text), 1, diagnostics);
  ASSERT_FALSE(diagnostics.warnings().empty());
  EXPECT_TRUE(diagnostics.warnings()[0].ends_with(
      "the physical volume 'bone' contains no supported element; it is not kept as a set"))
      << diagnostics.warnings()[0];
}

TEST(Gmsh, RefusesHexahedraOfHigherOrder) {
  EXPECT_NE(gmsh_error_of(read_text(data("second_order.msh"))).find("hexahedra with 27 nodes"),
            std::string::npos);
}

TEST(Gmsh, DoesNotTrustCounts) {
  EXPECT_NE(gmsh_error_of(replaced("two_msh22.msh", "$Nodes\n12", "$Nodes\n1200000000000"))
                .find("m.msh:12: 1,200,000,000,000 nodes are declared"),
            std::string::npos);
  std::string binary = read_text(data("two_msh41_binary.msh"));
  const std::size_t nodes = binary.find("$Nodes\n") + 7;
  for (std::size_t i = 8; i < 15; ++i) binary[nodes + i] = '\x7f';
  EXPECT_NE(gmsh_error_of(binary).find("nodes are declared"), std::string::npos)
      << gmsh_error_of(binary);
  EXPECT_NE(gmsh_error_of(binary).find("m.msh, byte "), std::string::npos);
}

TEST(Gmsh, TagsMayBeFarApart) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n";
  for (int i = 0; i < 8; ++i) {
    text += std::to_string(1000000000 + 7 * i) + " " + std::to_string(i % 2) + " 0 0\n";
  }
  text += "$EndNodes\n$Elements\n1\n77 5 0";
  for (int i = 7; i >= 0; --i) text += " " + std::to_string(1000000000 + 7 * i);
  text += "\n$EndElements\n";
  const Mesh mesh = read_mesh(folder.write("m.msh", text), 1, diagnostics);
  EXPECT_EQ(mesh.hexahedra[0], (Hexahedron{7, 6, 4, 5, 3, 2, 0, 1}));
  EXPECT_EQ(mesh.point_ids[3], 1000000021u);
  EXPECT_EQ(mesh.element_ids[0], 77u);
}

}  // namespace
}  // namespace suture
