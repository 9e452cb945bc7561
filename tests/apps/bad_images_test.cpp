// SPDX-License-Identifier: GPL-3.0-or-later
//
// Files that give the shape of a body, in commands and scenes, and what is wrong with them.
#include "tests/apps/program.hpp"
#include "tests/images/image_files.hpp"

namespace suture::testing {
namespace {

using test::meta;
using test::Nifti;
using test::voxels;

constexpr test::Size grid{12, 8, 8};
const std::string spacing = "ElementSpacing = 2 2 2\n";

double halves(double i, double, double) { return i < 6 ? 1 : 4; }

const std::string tetrahedron =
    "MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
    "Tetrahedra 1\n1 2 3 4 7\nEnd\n";

class BadImages : public Program {
 public:
  BadImages() {
    write("halves.mha", meta(grid, spacing, voxels(grid, halves)));
    write("organ.mesh", tetrahedron);
    write("cube.obj",
          "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n"
          "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
  }
  Outcome check(const std::string& mesh) const { return scene("check", "", {"/mesh=" + mesh}); }
  /// `file` with one label, and words of the only message.
  void expect_refused(const std::string& file, const std::string& words,
                      const std::string& label = "1") const {
    const Outcome outcome = check("{\"file\": \"" + file + "\", \"labels\": {\"" + label +
                                  "\": \"liver\"}, \"cells\": 50}");
    EXPECT_EQ(outcome.code, 3) << outcome;
    EXPECT_TRUE(outcome.says(words)) << words << "\n" << outcome;
  }
};

TEST_F(BadImages, TheSoundOneIsFilled) {
  const Outcome info = suture({"mesh", "info", "halves.mha"});
  EXPECT_EQ(info.code, 0) << info;
  EXPECT_TRUE(info.says("an image of 12 x 8 x 8 voxels of uint8")) << info;
  EXPECT_TRUE(info.says("label 4: 384 voxels, 3.072e-06 m^3")) << info;
  const Outcome filled = suture({"mesh", "fill", "halves.mha", "--cells", "500", "--label",
                                 "1=liver", "--label", "4=vessel", "-o", "f.vtu"});
  EXPECT_EQ(filled.code, 0) << filled;
  EXPECT_TRUE(filled.says("set of elements \"vessel\": ")) << filled;
  EXPECT_EQ(suture({"mesh", "fill", "halves.mha", "--cells", "500", "-o", "f.off"}).code, 0);
  EXPECT_EQ(
      check(R"({"file": "halves.mha", "labels": {"1": "liver", "4": "vessel"}, "cells": 100})")
          .code,
      0);
}

TEST_F(BadImages, HaveReferencesForTheirSurface) {
  const Outcome cited = scene(
      "cite", "", {R"(/mesh={"file": "halves.mha", "labels": {"1": "liver"}, "cells": 100})"});
  EXPECT_EQ(cited.code, 0) << cited;
  EXPECT_TRUE(cited.says("surface of a label image")) << cited;
}

TEST_F(BadImages, HeadersAndVoxels) {
  write("none.mha", meta(grid, "", voxels(grid, halves)));
  expect_refused("none.mha", "states no spacing");
  write("short.mha", meta(grid, spacing, "123"));
  expect_refused("short.mha", "is shorter than");
  write("empty.mha", meta(grid, spacing, std::string(768, '\0')));
  expect_refused("empty.mha", "all voxels are 0");
  write("float.mha",
        meta(grid, spacing, voxels<float>(grid, [](double i, double, double) { return i / 2; }),
             "MET_FLOAT"));
  expect_refused("float.mha", "voxel (1, 0, 0) has the value 0.5");
  write("time.nii", Nifti{.dim = {4, 4, 4, 4, 3, 1, 1, 1}}.file(std::string(192, '\1')));
  expect_refused("time.nii", "has 4 axes (4 x 4 x 4 x 3)");
  Nifti colours{.dim = {3, 4, 4, 4, 1, 1, 1, 1}};
  colours.type = 128;
  write("colours.nii", colours.file(std::string(192, '\1')));
  expect_refused("colours.nii", "3 values per voxel, such as colours");
}

TEST_F(BadImages, Labels) {
  expect_refused("halves.mha", "no voxel has the label 3; the nearest one is 4", "3");
  expect_refused("halves.mha", "'one' is not a label; labels are whole numbers", "one");
  for (const auto& [labels, words] : {std::pair{"{}", "/mesh/labels: is empty"},
                                      {R"({"1": 2})", "/mesh/labels/1: must be a string"},
                                      {R"({"1": ""})", "/mesh/labels/1: is empty; name the region"},
                                      {"7", "/mesh/labels: must be an object"}}) {
    const Outcome outcome =
        check(std::string(R"({"file": "halves.mha", "cells": 50, "labels": )") + labels + "}");
    EXPECT_EQ(outcome.code, 3) << outcome;
    EXPECT_TRUE(outcome.says(words)) << outcome;
  }
  const Outcome no_size = check(R"({"file": "halves.mha", "labels": {"1": "liver"}})");
  EXPECT_TRUE(no_size.says("must have exactly one of 'cells', 'edge'")) << no_size;
  EXPECT_EQ(
      suture({"mesh", "fill", "halves.mha", "--cells", "9", "--label", "1", "-o", "f.vtu"}).code,
      2);
}

// Each message names what takes the file.
TEST_F(BadImages, FilesOfOtherKinds) {
  struct Case {
    std::string mesh, words;
  };
  const Case cases[] = {
      {R"({"file": "halves.mha"})", "it is an image: /mesh takes it as \"file\" with \"labels\""},
      {R"({"surface": "halves.mha", "cells": 9})", "it is an image: /mesh takes it"},
      {R"({"file": "cube.obj"})", "it is a surface: /mesh takes it as \"surface\" with \"cells\""},
      {R"({"surface": "organ.mesh", "cells": 9})", "it is a mesh: /mesh takes it as \"file\""},
      {R"({"file": "organ.mesh"})",
       "with \"cells\" beside \"file\" in a scene, and in 'suture mesh"},
      {R"({"file": "organ.mesh", "labels": {"1": "a"}, "cells": 9})", "it is a mesh: /mesh takes"}};
  for (const Case& bad : cases) {
    const Outcome outcome = check(bad.mesh);
    EXPECT_EQ(outcome.code, 3) << outcome;
    EXPECT_TRUE(outcome.says(bad.words)) << bad.words << "\n" << outcome;
  }
  const Outcome info = suture({"mesh", "info", "organ.mesh"});
  EXPECT_EQ(info.code, 0) << info;
  EXPECT_TRUE(info.says("4 points, 1 solid cell, 4 faces on the boundary")) << info;
  EXPECT_TRUE(info.says("set of elements \"ref 7\": 1")) << info;
  const Outcome convert = suture({"mesh", "convert", "halves.mha", "m.vtu"});
  EXPECT_EQ(convert.code, 3) << convert;
  EXPECT_TRUE(convert.says("'suture mesh fill'")) << convert;
}

}  // namespace
}  // namespace suture::testing
