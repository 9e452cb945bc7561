// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/images/image_header.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "kernel/base/error.hpp"
#include "tests/geometry/surfaces.hpp"
#include "tests/images/image_files.hpp"
#include "tests/mesh/temporary_folder.hpp"

namespace suture {
namespace {

using test::meta;
using test::Nifti;
using test::nrrd;
using test::Size;

constexpr Size small{3, 2, 2};
const std::string ones(12, '\1');

ImageHeader header_of(const std::string& name, const std::string& text) {
  const TemporaryFolder folder;
  return read_image_header(folder.write(name, text));
}

std::string header_error(const std::string& name, const std::string& text) {
  return test::error_of<InputError>([&] { header_of(name, text); });
}

void expect_near(const Vec3& a, const Vec3& b) {
  for (std::size_t r = 0; r < 3; ++r) EXPECT_NEAR(a[r], b[r], 1e-6);
}

// The same axes in four ways: i along y with 0.5, j along z with 1, k along x with 2.
TEST(ImageHeader, FormatsStateTheSamePlace) {
  Nifti by_rows{.dim = {3, 3, 2, 2, 1, 1, 1, 1}};
  by_rows.sform = 1;
  by_rows.rows = {0, 0, 2, 1, 0.5, 0, 0, 2, 0, 1, 0, 3};
  Nifti by_quaternion{.dim = {3, 3, 2, 2, 1, 1, 1, 1}};
  by_quaternion.pixdim = {1, 0.5, 1, 2, 0, 0, 0, 0};
  by_quaternion.qform = 1;
  by_quaternion.quaternion = {0.5, 0.5, 0.5, 1, 2, 3};
  const std::pair<const char*, std::string> files[] = {
      {"a.nii", by_rows.file(ones)},
      {"b.nii", by_quaternion.file(ones)},
      {"c.mha", meta(small,
                     "TransformMatrix = 0 1 0 0 0 1 1 0 0\nOffset = 1 2 3\nElementSpacing = 0.5 1 "
                     "2\n",
                     ones)},
      {"d.nrrd", nrrd(small,
                      "space: left-posterior-superior\nspace directions: (0,0.5,0) (0,0,1) "
                      "(2,0,0)\nspace origin: (1,2,3)\n",
                      ones)}};
  for (const auto& [name, text] : files) {
    SCOPED_TRACE(name);
    const ImageHeader image = header_of(name, text);
    EXPECT_EQ(image.size, small);
    EXPECT_EQ(image.type, VoxelType::uint8);
    EXPECT_EQ(image.unit, 1e-3);
    expect_near(image.origin, {1, 2, 3});
    expect_near(image.steps[0], {0, 0.5, 0});
    expect_near(image.steps[1], {0, 0, 1});
    expect_near(image.steps[2], {2, 0, 0});
  }
}

// Half turns are exact, although their quaternions are rounded.
TEST(ImageHeader, TurnsByHalf) {
  Nifti image{.dim = {3, 3, 2, 2, 1, 1, 1, 1}};
  image.qform = 1;
  const float half = std::sqrt(0.5f);
  image.quaternion = {half, half, 0, 0, 0, 0};
  const ImageHeader header = header_of("a.nii", image.file(ones));
  expect_near(header.steps[0], {0, 1, 0});
  expect_near(header.steps[1], {1, 0, 0});
  expect_near(header.steps[2], {0, 0, -1});
}

TEST(ImageHeader, TakesTheSformBeforeTheQformBeforeTheSpacing) {
  Nifti image{.dim = {3, 3, 2, 2, 1, 1, 1, 1}};
  image.pixdim = {-1, 4, 5, 6, 0, 0, 0, 0};
  expect_near(header_of("a.nii", image.file(ones)).steps[2], {0, 0, 6});
  image.qform = 1;  // k is reversed by pixdim[0]
  expect_near(header_of("a.nii", image.file(ones)).steps[2], {0, 0, -6});
  image.sform = 1;
  image.rows = {7, 0, 0, 0, 0, 8, 0, 0, 0, 0, 9, 0};
  expect_near(header_of("a.nii", image.file(ones)).steps[2], {0, 0, 9});
}

TEST(ImageHeader, TakesUnitsAndScalesOfValues) {
  Nifti image{.dim = {3, 3, 2, 2, 1, 1, 1, 1}};
  image.units = 1;
  image.slope = 2;
  image.intercept = 1;
  const ImageHeader header = header_of("a.nii", image.file(ones));
  EXPECT_EQ(header.unit, 1);
  EXPECT_EQ(header.slope, 2);
  EXPECT_EQ(header.intercept, 1);
  image.units = 3;
  EXPECT_EQ(header_of("a.nii", image.file(ones)).unit, 1e-6);
  EXPECT_EQ(
      header_of("a.nrrd", nrrd(small, "spacings: 1 1 1\nspace units: \"cm\" \"cm\" \"cm\"\n", ones))
          .unit,
      1e-2);
}

// Long headers and others of the same kind may follow.
TEST(ImageHeader, SaysWhatIsWrong) {
  Nifti nifti{.dim = {4, 3, 2, 1, 2, 1, 1, 1}};
  EXPECT_NE(header_error("a.nii", nifti.file(ones)).find("has 4 axes (3 x 2 x 1 x 2); save one"),
            std::string::npos);
  nifti.dim = {3, 2, 2, 1, 1, 1, 1, 1};
  nifti.type = 128;
  EXPECT_NE(header_error("a.nii", nifti.file(ones)).find("has 3 values per voxel, such as colours"),
            std::string::npos);
  nifti.type = 2;
  nifti.pixdim = {};
  EXPECT_NE(header_error("a.nii", nifti.file(ones)).find("states no spacing"), std::string::npos);
  nifti.sform = 1;
  nifti.rows = {1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0};
  EXPECT_NE(header_error("a.nii", nifti.file(ones)).find("lie in a plane"), std::string::npos);
  EXPECT_NE(header_error("a.nii", "garbage").find("expected NIfTI"), std::string::npos);
  EXPECT_NE(header_error("a.nii", "").find("is empty"), std::string::npos);
  EXPECT_NE(header_error("a.mha", meta(small, "", ones)).find("states no spacing"),
            std::string::npos);
  EXPECT_NE(header_error("a.mha",
                         meta(small, "ElementSpacing = 1 1 1\nElementNumberOfChannels = 3\n", ones))
                .find("3 values per voxel"),
            std::string::npos);
  EXPECT_NE(header_error("a.mha", "ObjectType = Image\n").find("header has no end"),
            std::string::npos);
  EXPECT_NE(header_error("a.mha", meta(small, "ElementSpacing = 1 x 1\n", ones))
                .find("'ElementSpacing' of the header must be numbers, is '1 x 1'"),
            std::string::npos);
  EXPECT_NE(header_error("a.nrrd", nrrd(small, "", ones)).find("states no spacing"),
            std::string::npos);
  EXPECT_NE(header_error("a.nrrd", nrrd(small, "spacings: 1 1 1\n", ones, "bzip2"))
                .find("in the encoding 'bzip2' are not read"),
            std::string::npos);
  EXPECT_NE(
      header_error("a.nrrd",
                   "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 3 2 2 1\nkinds: RGB-color domain "
                   "domain domain\nencoding: raw\n\n")
          .find("3 values per voxel"),
      std::string::npos);
}

}  // namespace
}  // namespace suture
