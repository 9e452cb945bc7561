// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/parts/fill_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "kernel/base/error.hpp"
#include "kernel/mesh/box.hpp"
#include "kernel/mesh/mesh_file.hpp"
#include "kernel/parts/shape_boundary.hpp"
#include "tests/geometry/surfaces.hpp"
#include "tests/mesh/temporary_folder.hpp"
#include "tests/parts/filled_mesh.hpp"

namespace suture {
namespace {

using test::edge_of;
using test::volume_of;

using Cells = std::vector<std::vector<Index>>;

/// Cells in VTK's order, of 4, 5 or 6 corners.
struct Drawing {
  std::vector<Vec3> points;
  Cells cells;
  std::vector<int> region;             // 1, 2, ..., by cell
  std::vector<std::vector<Index>> x0;  // triangles of the boundary at x = 0
};

/// The unit cube of 3 x 3 x 3 cubes of six tetrahedra each; region 1 up to x = 1/3, 2 beyond.
Drawing cube_of_tetrahedra() {
  const Mesh box = make_box({.size = {1, 1, 1}, .cells = {3, 3, 3}});
  Drawing cube;
  cube.points = box.points;
  constexpr int path[6][2] = {{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}};
  for (std::size_t e = 0; e < box.hexahedra.size(); ++e) {
    const Hexahedron& x = box.hexahedra[e];
    for (const auto& [a, b] : path) {
      cube.cells.push_back({x[0], x[a], x[b], x[7]});
      cube.region.push_back(e % 3 == 0 ? 1 : 2);
    }
    if (e % 3 != 0) continue;
    cube.x0.push_back({x[0], x[2], x[6]});
    cube.x0.push_back({x[0], x[6], x[4]});
  }
  return cube;
}

/// A cube as a wedge, a wedge cut into a pyramid and a tetrahedron.
Drawing mixed_cube() {
  Drawing cube;
  for (int i = 0; i < 8; ++i)
    cube.points.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2 & 1)});
  // The wedge x <= y: 0 2 3, 4 6 7. The other one, 0 3 1, 4 7 5: around 5.
  cube.cells = {{0, 2, 3, 4, 6, 7}, {0, 3, 7, 4, 5}, {0, 3, 1, 5}};
  cube.region = {1, 1, 1};
  return cube;
}

std::string numbers(const std::vector<Index>& nodes, Index first) {
  std::string text;
  for (const Index node : nodes) text += " " + std::to_string(node + first);
  return text;
}

std::string points_text(const Drawing& drawing, const std::string& end, bool numbered = false) {
  std::ostringstream text;
  text.precision(17);
  for (std::size_t i = 0; i < drawing.points.size(); ++i) {
    if (numbered) text << i + 1 << ' ';
    text << drawing.points[i][0] << ' ' << drawing.points[i][1] << ' ' << drawing.points[i][2]
         << end << '\n';
  }
  return text.str();
}

std::string gmsh2(const Drawing& d) {
  std::string text =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n3 1 \"soft\"\n3 2 "
      "\"hard\"\n2 5 \"clamp\"\n$EndPhysicalNames\n$Nodes\n" +
      std::to_string(d.points.size()) + "\n" + points_text(d, "", true) + "$EndNodes\n$Elements\n" +
      std::to_string(d.cells.size() + d.x0.size()) + "\n";
  int number = 0;
  for (const auto& triangle : d.x0)
    text += std::to_string(++number) + " 2 2 5 1" + numbers(triangle, 1) + "\n";
  std::string data;
  for (std::size_t c = 0; c < d.cells.size(); ++c) {
    const int type = d.cells[c].size() == 4 ? 4 : d.cells[c].size() == 5 ? 7 : 6;
    const std::string region = std::to_string(d.region[c]);
    text += std::to_string(++number) + " " + std::to_string(type) + " 2 " + region + " 1" +
            numbers(d.cells[c], 1) + "\n";
    data += std::to_string(number) + " " + std::to_string(10 * d.region[c]) + "\n";
  }
  return text + "$EndElements\n$ElementData\n1\n\"E\"\n1\n0\n3\n0\n1\n" +
         std::to_string(d.cells.size()) + "\n" + data + "$EndElementData\n";
}

std::string medit(const Drawing& d) {
  std::string text = "MeshVersionFormatted 2\nDimension 3\nVertices\n" +
                     std::to_string(d.points.size()) + "\n" + points_text(d, " 0");
  if (!d.x0.empty()) text += "Triangles\n" + std::to_string(d.x0.size()) + "\n";
  for (const auto& triangle : d.x0) text += numbers(triangle, 1) + " 5\n";
  for (const auto& [name, corners] :
       {std::pair{"Tetrahedra", 4u}, std::pair{"Pyramids", 5u}, std::pair{"Prisms", 6u}}) {
    std::string cells;
    int count = 0;
    for (std::size_t c = 0; c < d.cells.size(); ++c) {
      if (d.cells[c].size() != corners) continue;
      cells += numbers(d.cells[c], 1) + " " + std::to_string(d.region[c]) + "\n";
      ++count;
    }
    if (count > 0) text += std::string(name) + "\n" + std::to_string(count) + "\n" + cells;
  }
  return text + "End\n";
}

std::string vtk(const Drawing& d) {
  std::string cells, types, regions, values;
  std::size_t words = 0;
  for (std::size_t c = 0; c < d.cells.size(); ++c) {
    const std::size_t corners = d.cells[c].size();
    words += corners + 1;
    cells += std::to_string(corners) + numbers(d.cells[c], 0) + "\n";
    types += corners == 4 ? "10\n" : corners == 5 ? "14\n" : "13\n";
    regions += std::to_string(d.region[c]) + "\n";
    values += std::to_string(10 * d.region[c]) + ".0\n";
  }
  const std::string count = std::to_string(d.cells.size());
  return "# vtk DataFile Version 3.0\ncells\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " +
         std::to_string(d.points.size()) + " double\n" + points_text(d, "") + "CELLS " + count +
         " " + std::to_string(words) + "\n" + cells + "CELL_TYPES " + count + "\n" + types +
         "CELL_DATA " + count + "\nSCALARS region int 1\nLOOKUP_TABLE default\n" + regions +
         "SCALARS E double 1\nLOOKUP_TABLE default\n" + values;
}

Mesh shape_from(const std::string& name, const std::string& text) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  return read_shape(folder.write(name, text), 1, diagnostics, all_arrays);
}

Mesh filled(const Mesh& shape, double edge) {
  Diagnostics diagnostics;
  return fill_shape(shape, {.edge = edge}, false, diagnostics);
}

TEST(FillShape, FormatsGiveTheSameBody) {
  const Drawing cube = cube_of_tetrahedra();
  const Mesh gmsh = shape_from("m.msh", gmsh2(cube));
  ASSERT_EQ(gmsh.hexahedra.size(), 162u);
  for (const auto& [name, text] : {std::pair{"m.mesh", medit(cube)}, {"m.vtk", vtk(cube)}}) {
    const Mesh mesh = shape_from(name, text);
    EXPECT_EQ(mesh.points, gmsh.points) << name;
    EXPECT_EQ(mesh.hexahedra, gmsh.hexahedra) << name;
  }
  EXPECT_EQ(gmsh.element_sets.at("soft"),
            shape_from("m.vtk", vtk(cube)).element_sets.at("region 1"));
  EXPECT_EQ(gmsh.element_sets.at("hard"),
            shape_from("m.mesh", medit(cube)).element_sets.at("ref 2"));
  EXPECT_EQ(gmsh.point_sets.at("clamp"),
            shape_from("m.mesh", medit(cube)).point_sets.at("triangles ref 5"));
}

TEST(FillShape, FindsTheBoundaryOfCellsOfAllKinds) {
  const Drawing drawing = mixed_cube();
  for (const auto& [name, text] :
       {std::pair{"m.msh", gmsh2(drawing)}, {"m.mesh", medit(drawing)}, {"m.vtk", vtk(drawing)}}) {
    const Mesh shape = shape_from(name, text);
    ASSERT_EQ(shape.hexahedra.size(), 3u) << name;
    // Six sides of the cube, of which four are divided.
    EXPECT_EQ(boundary_of(shape).size(), 10u) << name;
    EXPECT_NEAR(volume_of(filled(shape, 0.05)), 1, 0.01) << name;
  }
}

std::string numbers_text(const std::vector<int>& values) {
  std::string text;
  for (const int value : values) text += std::to_string(value) + " ";
  return text;
}

std::string vtu(const Drawing& d) {
  std::string nodes;
  std::vector<int> ends, types;
  for (const auto& cell : d.cells) {
    nodes += numbers(cell, 0) + "\n";
    ends.push_back((ends.empty() ? 0 : ends.back()) + static_cast<int>(cell.size()));
    types.push_back(cell.size() == 4 ? 10 : cell.size() == 5 ? 14 : 13);
  }
  const auto array = [](const std::string& head, const std::string& values) {
    return "<DataArray format=\"ascii\" " + head + ">\n" + values + "\n</DataArray>\n";
  };
  return "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
         "<UnstructuredGrid>\n<Piece NumberOfPoints=\"" +
         std::to_string(d.points.size()) + "\" NumberOfCells=\"" + std::to_string(d.cells.size()) +
         "\">\n<Points>\n" +
         array("type=\"Float64\" NumberOfComponents=\"3\"", points_text(d, "")) +
         "</Points>\n<Cells>\n" + array("type=\"Int32\" Name=\"connectivity\"", nodes) +
         array("type=\"Int32\" Name=\"offsets\"", numbers_text(ends)) +
         array("type=\"UInt8\" Name=\"types\"", numbers_text(types)) + "</Cells>\n<CellData>\n" +
         array("type=\"Int32\" Name=\"region\"", numbers_text(d.region)) +
         "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

// A wedge of 1/2, a pyramid of 1/3 and a tetrahedron of 1/6, each a material of its own.
TEST(FillShape, CountsCellsOfAllKindsByVolume) {
  Drawing drawing = mixed_cube();
  drawing.region = {1, 2, 3};
  const std::tuple<const char*, std::string, const char*> files[] = {
      {"m.mesh", medit(drawing), "ref "},
      {"m.vtk", vtk(drawing), "region "},
      {"m.vtu", vtu(drawing), "region "}};
  for (const auto& [name, text, prefix] : files) {
    SCOPED_TRACE(name);
    const Mesh mesh = filled(shape_from(name, text), 0.11);
    const std::vector<double> volumes = test::volumes_of_elements(mesh);
    for (const auto& [region, volume] : {std::pair{"1", 1.0 / 2}, {"2", 1.0 / 3}, {"3", 1.0 / 6}}) {
      double sum = 0;
      for (Index e = 0; e < mesh.hexahedra.size(); ++e)
        sum += volumes[e] * test::share_of(mesh, e, prefix + std::string(region));
      EXPECT_NEAR(sum, volume, 0.015) << region;
    }
  }
}

// Files of several materials often repeat the points between them.
TEST(FillShape, JoinsPointsAtTheSamePlace) {
  Drawing cube = cube_of_tetrahedra();
  const std::size_t faces = boundary_of(shape_from("m.msh", gmsh2(cube))).size();
  EXPECT_EQ(faces, 6u * 9 * 2);
  const std::vector<Vec3> points = cube.points;
  cube.points.insert(cube.points.end(), points.begin(), points.end());
  for (std::size_t c = 0; c < cube.cells.size(); ++c)
    if (cube.region[c] == 2)
      for (Index& node : cube.cells[c]) node += static_cast<Index>(points.size());
  EXPECT_EQ(boundary_of(shape_from("m.msh", gmsh2(cube))).size(), faces);
}

TEST(FillShape, CarriesRegionsValuesAndBoundaries) {
  const Mesh mesh = filled(shape_from("m.msh", gmsh2(cube_of_tetrahedra())), 0.11);
  EXPECT_NEAR(volume_of(mesh), 1, 0.02);
  const auto &soft = mesh.element_sets.at("soft"), &hard = mesh.element_sets.at("hard");
  EXPECT_EQ(soft.size() + hard.size(), mesh.hexahedra.size());
  ASSERT_EQ(mesh.arrays.size(), 1u);
  EXPECT_EQ(mesh.arrays[0].name, "E");
  const double edge = edge_of(mesh);
  for (Index e = 0; e < mesh.hexahedra.size(); ++e) {
    // The share of the cube inside the body that lies beyond x = 1/3.
    const double low = std::max(mesh.points[mesh.hexahedra[e][0]][0], 0.0);
    const double high = std::min(mesh.points[mesh.hexahedra[e][0]][0] + edge, 1.0);
    const double share = std::clamp((high - 1.0 / 3) / (high - low), 0.0, 1.0);
    EXPECT_NEAR(mesh.arrays[0].values[e], 10 + 10 * share, 1e-9) << "element " << e;
    EXPECT_EQ(std::binary_search(hard.begin(), hard.end(), e), share > 0.5) << "element " << e;
  }
  const std::vector<Index>& clamp = mesh.point_sets.at("clamp");
  EXPECT_FALSE(clamp.empty());
  for (const Index node : clamp) {
    EXPECT_GT(mesh.points[node][0], -edge);
    EXPECT_LT(mesh.points[node][0], edge);
  }
  // All nodes beyond the side x = 0, away from the others.
  for (Index node = 0; node < mesh.points.size(); ++node) {
    const auto& [x, y, z] = mesh.points[node];
    const bool is_beyond = x < 0 && std::min(y, z) > 0 && std::max(y, z) < 1;
    EXPECT_TRUE(!is_beyond || std::binary_search(clamp.begin(), clamp.end(), node)) << node;
  }
}

TEST(FillShape, ReadsFormat4AndTheCornersOfQuadraticCells) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  std::string nodes, places;
  for (int i = 1; i <= 10; ++i) nodes += std::to_string(i) + "\n";
  for (const char* place :
       {"0 0 0", "2 0 0", "0 2 0", "0 0 2", "1 0 0", "1 1 0", "0 1 0", "0 0 1", "0 1 1", "1 0 1"})
    places += std::string(place) + "\n";
  const auto file =
      folder.write("m.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 10 1 10\n3 1 0 10\n" +
                                nodes + places +
                                "$EndNodes\n$Elements\n1 1 1 1\n3 1 11 1\n1 1 2 3 4 5 6 7 8 9 10\n"
                                "$EndElements\n");
  const Mesh shape = read_shape(file, 1, diagnostics);
  ASSERT_EQ(shape.hexahedra.size(), 1u);
  EXPECT_EQ(shape.hexahedra[0], (Hexahedron{0, 1, 2, 2, 3, 3, 3, 3}));
  ASSERT_EQ(diagnostics.warnings().size(), 1u);
  EXPECT_NE(diagnostics.warnings()[0].find("only the corners are read"), std::string::npos);
}

TEST(FillShape, SaysWhatIsWrong) {
  Drawing open = cube_of_tetrahedra();
  open.cells.clear();
  open.region.clear();
  EXPECT_NE(test::error_of<InputError>([&] { shape_from("m.msh", gmsh2(open)); })
                .find("no tetrahedra, pyramids, wedges or hexahedra; the file contains 64 points, "
                      "18 triangles"),
            std::string::npos);
  Drawing bad = cube_of_tetrahedra();
  bad.cells[7][2] = 99;
  EXPECT_NE(test::error_of<InputError>([&] {
              shape_from("m.mesh", medit(bad));
            }).find("tetrahedron 8 has vertex 100; the vertices are numbered 1 to 64"),
            std::string::npos);
}

}  // namespace
}  // namespace suture
