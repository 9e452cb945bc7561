// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/geometry/surface_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

#include "kernel/base/error.hpp"
#include "tests/geometry/surfaces.hpp"

namespace suture {
namespace {

using test::error_of;
using test::file_with;

std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

std::string read_error(const std::string& name, const std::string& text) {
  const auto path = file_with(name, text);
  return error_of<InputError>([&] { read_triangles(path); });
}

TEST(SurfaceFile, MakesTheRoundTrip) {
  const TriangleSurface sphere = test::sphere_surface({0.1, 0.2, 0.3}, 1, 2);
  for (const char* name : {"s.obj", "s.off", "s.ply"}) {
    const auto path = file_with(name, "");
    write_surface(path, sphere);
    const TriangleSurface read = read_triangles(path);
    EXPECT_EQ(read.points, sphere.points) << name;
    EXPECT_EQ(read.triangles, sphere.triangles) << name;
  }
}

TEST(SurfaceFile, MakesTheRoundTripInSinglePrecision) {
  const TriangleSurface sphere = test::sphere_surface({0.1, 0.2, 0.3}, 1, 2);
  const auto path = file_with("s.stl", "");
  write_surface(path, sphere);
  EXPECT_EQ(std::filesystem::file_size(path), 84 + 50 * sphere.triangles.size());
  const TriangleSurface read = read_triangles(path);
  ASSERT_EQ(read.triangles.size(), sphere.triangles.size());
  for (std::size_t t = 0; t < read.triangles.size(); ++t)
    for (int n = 0; n < 3; ++n)
      for (int a = 0; a < 3; ++a)
        EXPECT_NEAR(read.points[read.triangles[t][n]][a], sphere.points[sphere.triangles[t][n]][a],
                    1e-6);
}

constexpr const char* vtp = R"(<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt32">
<PolyData><Piece NumberOfPoints="4" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="2">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 1 1 0 0 1 0.5</DataArray></Points>
<Polys><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 0 2 3</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">3 6</DataArray></Polys>
</Piece></PolyData></VTKFile>)";

TEST(SurfaceFile, ReadsVtp) {
  const TriangleSurface surface = read_triangles(file_with("s.vtp", vtp), 2);
  EXPECT_EQ(surface.points, (std::vector<Vec3>{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 1}}));
  EXPECT_EQ(surface.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(SurfaceFile, SaysWhatIsWrongInVtp) {
  std::string text = vtp;
  text.replace(text.find("0 2 3"), 5, "0 2 4");
  EXPECT_NE(read_error("v.vtp", text).find("point 4"), std::string::npos);
  text = vtp;
  text.replace(text.find("3 6<"), 3, "3 5");
  EXPECT_NE(read_error("v.vtp", text).find("6 numbers, expected 5"), std::string::npos);
  text = vtp;
  text.replace(text.find("PolyData"), 8, "ImageData");
  EXPECT_NE(read_error("v.vtp", text).find("PolyData with polygons"), std::string::npos);
}

TEST(SurfaceFile, SaysWhatIsWrong) {
  EXPECT_NE(read_error("a.slt", "x").find("did you mean '.stl'"), std::string::npos);
  EXPECT_NE(read_error("a.obj", "v 0 0 0\n").find("no face"), std::string::npos);
  EXPECT_NE(read_error("a.off", "OFF\n3 1").find("a.off:2: 3 points are"), std::string::npos);
  EXPECT_NE(read_error("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
                .find("1 face is not triangular"),
            std::string::npos);
  EXPECT_NE(error_of<InputError>([] { read_triangles("no-such.stl"); }).find("no such file"),
            std::string::npos);
  EXPECT_NE(error_of<UsageError>([] { write_surface("a.obk", {}); }).find("did you mean '.obj'"),
            std::string::npos);
}

std::string ply_with(const std::string& header, const std::string& body) {
  return read_error("p.ply", "ply\nformat ascii 1.0\n" + header + "end_header\n" + body);
}

constexpr const char* ply_points =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
constexpr const char* ply_faces = "element face 1\nproperty list uchar int vertex_indices\n";
constexpr const char* three_points = "0 0 0\n1 0 0\n0 1 0\n";

// CGAL's reader dies of a property without an element.
TEST(SurfaceFile, SaysWhatIsWrongInTheHeaderOfPly) {
  const std::string points = ply_points, faces = ply_faces;
  EXPECT_EQ(ply_with(points + faces, std::string(three_points) + "3 0 1 2\n"), "");
  const auto says = [&](const std::string& header, const char* words) {
    const std::string error = ply_with(header, std::string(three_points) + "3 0 1 2\n");
    EXPECT_NE(error.find(words), std::string::npos) << header << error;
  };
  says("property float x\n", "p.ply:3: a property appears before the first 'element'");
  says("elemnt vertex 3\nproperty float x\n",
       "p.ply:3: 'elemnt' is not a keyword of the header (did");
  says("comment\nelement vertex x\n", "p.ply:4: 'x' is not a valid number of elements 'vertex'");
  says("element vertex\n", "p.ply:3: expected 'element NAME COUNT'");
  says("element vertex 3\nproperty flaot x\n", "p.ply:4: 'flaot' is not a property type (did");
  says("element vertex 3\nproperty x\n", "p.ply:4: expected 'property TYPE NAME'");
  says("element face 1\nproperty list float int vertex_indices\n", "must have an integer type");
  says("element vertex 3\nproperty float x\nproperty float y\n", "'vertex' has no property 'z'");
  says(points + "element face 1\nproperty int corner\n", "no list 'vertex_indices'");
  says(points + "element face 1\nproperty list int float vertex_index\n", "must be integers");
  says("element vertex 9\n" + faces, "the element 'vertex' has no property");
  says("element vertex 99999999999\nproperty float x\n", "99,999,999,999 elements 'vertex' are");
  EXPECT_NE(read_error("p.ply", "ply\nformat ascii 1.0\n").find("within its header"),
            std::string::npos);
  EXPECT_NE(read_error("p.ply", "plx\n").find("p.ply:1: expected 'ply'"), std::string::npos);
  EXPECT_NE(read_error("p.ply", "ply\nformat asci 1.0\n").find("p.ply:2"), std::string::npos);
}

TEST(SurfaceFile, SaysWhatIsWrongInTheBodyOfPly) {
  const std::string header = std::string(ply_points) + ply_faces;
  const auto says = [&](const std::string& body, const char* words) {
    const std::string error = ply_with(header, body);
    EXPECT_NE(error.find(words), std::string::npos) << body << error;
  };
  says("0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "p.ply:11: y is 'nan', which is not finite");
  says("0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "p.ply:13: a face uses point 3, but the 3 points");
  says("0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "p.ply:13: a face uses point -1");
  says("0 0 0\n1 0 0\n0 1 0\n9 0 1\n", "p.ply:13: 9 vertex_indices are declared");
  says("0 0 0\n1 0 0\n0 1 0\n3 0 1\n", "p.ply:14: the file ends where vertex_indices is expected");
  says("0 0 0\n1 0 0\n0.000000 1\n", "the file ends where z is expected: it is truncated");
}

TEST(SurfaceFile, SaysWhatIsWrongInObj) {
  const auto says = [&](const std::string& text, const char* words) {
    const std::string error = read_error("o.obj", text);
    EXPECT_NE(error.find(words), std::string::npos) << text << error;
  };
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  says("# c\nv 0 nan 0\n", "o.obj:2: expected a finite number, found 'nan'");
  says("v 0 1e400 0\n", "o.obj:1: expected a finite number, found '1e400'");
  says("v 0.05 -0-1 .05\n", "o.obj:1: expected a finite number, found '-0-1'");
  says("v 0 0 # 0\n", "o.obj:1: a point needs three numbers, found 2");
  says(points + "f 1 2 4\n", "o.obj:4: a face uses point 4, but the 3 points are numbered");
  says(points + "f 1 2 -4\n", "o.obj:4: a face uses point -4");
  says(points + "f 0 1 2\n", "o.obj:4: a face uses point 0");
  says(points + "f 1 2 x\n", "o.obj:4: expected the number of a point, found 'x'");
  says(points + "facet 1\nf 1 2 3\n", "o.obj:4: not a valid .obj line: 'facet' is not a keyword");
  says("v 0 0 0 \\\n# \\\n\nv 0 0\n", "o.obj:4: a point needs three numbers, found 2");
}

TEST(SurfaceFile, ReadsWhatObjAllows) {
  const TriangleSurface surface =
      read_triangles(file_with("o.obj",
                               "f 1/1 2/1\t3/1 # later points\r\nv\t0 0 0\nl 1 2\nv 1 0 0 1\n"
                               "v 0 1 0 .5 .5 .5\nv 0 0 1e-400\nf -4//1 \\\n -3//1 -1//1\nl 1 3"));
  EXPECT_EQ(surface.points, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}}));
  EXPECT_EQ(surface.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 1, 3}}));
}

TEST(SurfaceFile, SaysWhatIsWrongInOff) {
  const auto says = [&](const std::string& text, const char* words) {
    const std::string error = read_error("o.off", text);
    EXPECT_NE(error.find(words), std::string::npos) << text << error;
  };
  const std::string points = "OFF # c\n3 1 0\n0 0 0 255 0 0\n1 0 0\n\n0 1 0\n";
  EXPECT_EQ(read_error("o.off", points + "3 0 1 2 255 0 0\n"), "");
  says("OFF BINARY\n", "o.off:1: only text OFF files");
  says("4OFF\n1 0 0\n0 0 0 1\n", "with three coordinates per point");
  says("OFT\n", "o.off:1: expected OFF, found 'OFT'");
  says("OFF\n999999999 1 0\n0 0 0\n", "999,999,999 points are declared");
  says("OFF\n3 1 0\n0.00 0.00 0.00\n0 inf 0\n", "o.off:4: y is 'inf', which is not finite");
  says(points + "3 0 1 3\n", "o.off:7: a face uses point 3, but the 3 points are numbered from 0");
  says(points + "4294967295 0 1 2\n", "o.off:7: 4,294,967,295 corners are declared");
  says(points, "o.off:7: 1 faces are declared");
}

TEST(SurfaceFile, SaysThatStlIsTruncated) {
  const auto path = file_with("t.stl", "");
  write_surface(path, test::box_surface({0, 0, 0}, {1, 1, 1}));
  const std::string text = text_of(path);
  EXPECT_NE(
      read_error("t.stl", text.substr(0, 300))
          .find("300 bytes are too few for a binary STL file with 12 triangles, which needs 684"),
      std::string::npos);
  EXPECT_NE(read_error("t.stl", text + "more").find("4 bytes follow the 12 triangles"),
            std::string::npos);
}

constexpr const char* ascii_stl =
    "solid two triangles\n"
    "  facet normal 0 0 1\n    outer loop\n"
    "      vertex 0 0 0\n      vertex 1e0 0 0\n      vertex +1 1 0\n"
    "    endloop\n  endfacet\n"
    "  facet normal nan nan nan\n    outer loop\n"
    "      vertex -0.0 0 0\n      vertex 1 1 0\n      vertex 0 1 0.1\n"
    "    endloop\n  endfacet\n"
    "endsolid two triangles\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

// Variants of text that programs write; equal places are one point.
TEST(SurfaceFile, ReadsStlAsText) {
  std::string capitals = ascii_stl;
  for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string as_one_line = replaced(ascii_stl, "\n", " ");
  as_one_line.replace(as_one_line.find(" facet"), 1, "\n");  // the name of a solid ends its line
  const std::pair<const char*, std::string> variants[] = {
      {"as it is", ascii_stl},
      {"capitals", capitals},
      {"tab behind solid", replaced(ascii_stl, "solid two", "solid\ttwo")},
      {"carriage returns", replaced(ascii_stl, "\n", "\r\n")},
      {"byte order mark", std::string("\xef\xbb\xbf") + ascii_stl},
      {"one line", as_one_line},
      {"two solids",
       replaced(ascii_stl, "  endfacet\n  facet", "  endfacet\nendsolid\nsolid\n  facet")}};
  for (const auto& [name, text] : variants) {
    SCOPED_TRACE(name);
    const TriangleSurface read = read_triangles(file_with("a.stl", text));
    EXPECT_EQ(read.points, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.1}}));
    EXPECT_EQ(read.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  }
}

TEST(SurfaceFile, SaysWhatIsWrongInStlAsText) {
  const auto says = [&](const std::string& text, const char* words) {
    const std::string error = read_error("a.stl", text);
    EXPECT_NE(error.find(words), std::string::npos) << error;
  };
  says(replaced(ascii_stl, "endsolid two triangles\n", ""), "ends without 'endsolid'");
  says(replaced(ascii_stl, "0.1", "0,1"),
       "a.stl:13: expected a number (z), found '0,1': write dec");
  says(replaced(ascii_stl, "vertex 0 1", "vertx 0 1"),
       "a.stl:13: expected 'vertex', found 'vertx'");
  says(replaced(ascii_stl, "1e0 0 0", "1e0 0"), "a.stl:6: expected a number (z), found 'vertex'");
  says(std::string(ascii_stl).substr(0, 200), "truncated");
  says(replaced(ascii_stl, "1e0", "inf"), "not finite");
}

// On a lattice whose places meet often, zeros of both signs among them.
TEST(SurfaceFile, NumbersEqualPlacesOfBinaryStlOnce) {
  std::mt19937 random(1);
  std::string text(80, 'x');
  const auto put = [&](auto value) {
    const std::size_t end = text.size();
    text.resize(end + sizeof value);
    std::memcpy(text.data() + end, &value, sizeof value);
  };
  constexpr std::uint32_t triangles = 2000;
  put(triangles);
  std::map<Vec3, Index> number;
  std::vector<Vec3> points;
  std::vector<Triangle> corners;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    for (int c = 0; c < 3; ++c) put(0.F);
    Triangle& triangle = corners.emplace_back();
    for (Index& corner : triangle) {
      Vec3 point;
      for (double& x : point) {
        const float place = 0.1F * static_cast<float>(static_cast<int>(random() % 15) - 7);
        put(place == 0 && random() % 2 == 0 ? -0.F : place);
        x = place;
      }
      const auto [found, is_new] = number.emplace(point, static_cast<Index>(points.size()));
      if (is_new) points.push_back(point);
      corner = found->second;
    }
    put(std::uint16_t{0});
  }
  for (const char* beginning : {"x", "solid"}) {  // some binary files begin like text
    text.replace(0, std::strlen(beginning), beginning);
    const TriangleSurface read = read_triangles(file_with("lattice.stl", text));
    EXPECT_EQ(read.points, points);
    EXPECT_EQ(read.triangles, corners);
  }
}

// Values of every type, in both orders of bytes.
TEST(SurfaceFile, ReadsBinaryPly) {
  const std::string header =
      "endian 1.0\nelement vertex 3\nproperty float x\nproperty short y\nproperty uchar red\n"
      "property double z\nelement face 1\nproperty list uchar short vertex_indices\nend_header\n";
  const auto text = [&](const char* order, bool turn) {
    std::string body;
    const auto put = [&](auto value) {
      std::string bytes(sizeof value, ' ');
      std::memcpy(bytes.data(), &value, sizeof value);
      if (turn) std::ranges::reverse(bytes);
      body += bytes;
    };
    for (int i = 0; i < 3; ++i) {
      put(0.5F + static_cast<float>(i));
      put(static_cast<std::int16_t>(i * i - 300));
      put(std::uint8_t{255});
      put(i == 2 ? 1e-300 : 0.1);
    }
    put(std::uint8_t{3});
    for (const std::int16_t corner : {2, 0, 1}) put(corner);
    return std::string("ply\nformat binary_") + order + "_" + header + body;
  };
  const bool little = std::endian::native == std::endian::little;
  for (const auto& ply : {text("little", !little), text("big", little)}) {
    const TriangleSurface surface = read_triangles(file_with("b.ply", ply));
    EXPECT_EQ(surface.points,
              (std::vector<Vec3>{{0.5, -300, 0.1}, {1.5, -299, 0.1}, {2.5, -296, 1e-300}}));
    EXPECT_EQ(surface.triangles, (std::vector<Triangle>{{2, 0, 1}}));
  }
}

// A list's count of 2^32 - 1 would be allocated before it is read.
TEST(SurfaceFile, BoundsTheListsOfBinaryPly) {
  for (const char* order : {"little", "big"}) {
    std::string text = std::string("ply\nformat binary_") + order +
                       "_endian 1.0\nelement face 1\nproperty list uint int vertex_index\n"
                       "end_header\n\xff\xff\xff\xff";
    const std::string says =
        "b.ply, byte " + std::to_string(text.size()) + ": the file ends where vertex_index";
    EXPECT_NE(read_error("b.ply", text).find(says), std::string::npos);
    text.pop_back();
    EXPECT_NE(read_error("b.ply", text).find("truncated"), std::string::npos);
  }
}

TEST(SurfaceFile, RefusesNumbersThatAreNone) {
  const auto path = file_with("n.stl", "");
  write_surface(path, test::box_surface({0, 0, 0}, {1, 1, 1}));
  std::string text = text_of(path);
  for (std::size_t i = 0; i < 4; ++i) text[84 + 12 + i] = '\xff';  // first corner, x: NaN
  EXPECT_NE(read_error("n.stl", text).find("not finite"), std::string::npos);
}

// Truncated at every length: an error or a surface, never a crash.
TEST(SurfaceFile, SurvivesTruncation) {
  const TriangleSurface box = test::box_surface({0, 0, 0}, {1, 1, 1});
  for (const char* name : {"t.obj", "t.off", "t.ply", "t.stl"}) {
    const auto whole = file_with(name, "");
    write_surface(whole, box);
    const std::string text = text_of(whole);
    int refused = 0;
    for (std::size_t size = 0; size < text.size(); size += 7) {
      refused += read_error(name, text.substr(0, size)).empty() ? 0 : 1;
      Diagnostics diagnostics;
      error_of<InputError>([&] { close_surface(read_soup(whole), true, diagnostics); });
    }
    EXPECT_GT(refused, 0) << name;
  }
}

}  // namespace
}  // namespace suture
