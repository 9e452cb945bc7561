// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/images/label_image.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>

#include "kernel/base/error.hpp"
#include "tests/geometry/surfaces.hpp"
#include "tests/images/image_files.hpp"
#include "tests/mesh/temporary_folder.hpp"

namespace suture {
namespace {

using test::meta;
using test::nrrd;
using test::Size;
using test::voxels;

constexpr Size grid{4, 3, 2};
constexpr double all = 1e12;  // bytes of memory
const std::string spacing = "ElementSpacing = 1 1 1\n";

double label_at(double i, double j, double k) { return double(int(i + 2 * j + 3 * k) % 4); }

struct Read {
  Diagnostics diagnostics;
  LabelImage image;

  Read(const std::string& name, const std::string& text, LabelNames names = {},
       double memory = all) {
    const TemporaryFolder folder;
    image = read_labels(folder.write(name, text), {.names = std::move(names), .memory = memory},
                        diagnostics);
  }
};

std::string error_with(const std::string& name, const std::string& text, LabelNames names = {},
                       double memory = all) {
  return test::error_of<InputError>([&] { Read(name, text, std::move(names), memory); });
}

/// 15: zlib, 31: gzip.
std::string packed(const std::string& bytes, int window) {
  z_stream state{};
  EXPECT_EQ(deflateInit2(&state, 6, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string result(bytes.size() + 200, '\0');
  std::string in = bytes;
  state.next_in = reinterpret_cast<Bytef*>(in.data());
  state.avail_in = static_cast<uInt>(in.size());
  state.next_out = reinterpret_cast<Bytef*>(result.data());
  state.avail_out = static_cast<uInt>(result.size());
  EXPECT_EQ(deflate(&state, Z_FINISH), Z_STREAM_END);
  result.resize(state.total_out);
  deflateEnd(&state);
  return result;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

void expect_regions(const LabelImage& image) {
  ASSERT_EQ(image.size, grid);
  for (std::uint64_t k = 0; k < grid[2]; ++k)
    for (std::uint64_t j = 0; j < grid[1]; ++j)
      for (std::uint64_t i = 0; i < grid[0]; ++i) {
        const double label = label_at(double(i), double(j), double(k));
        const std::uint16_t region = image.region_of[image.place(i, j, k)];
        const std::string name = region == 0 ? "" : image.regions[region - 1];
        EXPECT_EQ(name, label == 0 ? "" : label == 3 ? "b" : "a") << i << ' ' << j << ' ' << k;
      }
}

TEST(LabelImage, ReadsAllTypesAndPackings) {
  const LabelNames names{{1, "a"}, {2, "a"}, {3, "b"}};
  const std::string bytes = voxels(grid, label_at);
  const std::string shorts = voxels<std::int16_t>(grid, label_at);
  std::string reversed = shorts;
  for (std::size_t i = 0; i < reversed.size(); i += 2) std::swap(reversed[i], reversed[i + 1]);
  test::Nifti nifti{.dim = {3, 4, 3, 2, 1, 1, 1, 1}};
  nifti.type = 16;
  const std::string floats = nifti.file(voxels<float>(grid, label_at));
  const std::pair<const char*, std::string> files[] = {
      {"a.mha", meta(grid, spacing, bytes)},
      {"b.mha", meta(grid, spacing, shorts, "MET_SHORT")},
      {"c.mha", meta(grid, spacing + "BinaryDataByteOrderMSB = True\n", reversed, "MET_SHORT")},
      {"d.mha", meta(grid, spacing + "CompressedData = True\n", packed(bytes, 15))},
      {"e.mha", meta(grid, spacing, voxels<double>(grid, label_at), "MET_DOUBLE")},
      {"f.mha", meta(grid, spacing, voxels<std::uint64_t>(grid, label_at), "MET_ULONG_LONG")},
      {"g.nrrd", nrrd(grid, "spacings: 1 1 1\n", bytes)},
      {"h.nrrd", nrrd(grid, "spacings: 1 1 1\n", packed(shorts, 31), "gzip", "short")},
      {"i.nii", floats},
      {"j.nii.gz", packed(floats, 31)},
      {"k.nii.gz", packed(floats.substr(0, 360), 31) + packed(floats.substr(360), 31)}};
  for (const auto& [name, text] : files) {
    SCOPED_TRACE(name);
    expect_regions(Read(name, text, names).image);
  }
}

TEST(LabelImage, ReadsVoxelsBesideTheHeader) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  folder.write("v.raw", "head" + voxels(grid, label_at));
  const std::string head = "NDims = 3\nDimSize = 4 3 2\n" + spacing +
                           "ElementType = MET_UCHAR\nHeaderSize = -1\nElementDataFile = v.raw\n";
  const LabelNames names{{1, "a"}, {2, "a"}, {3, "b"}};
  expect_regions(read_labels(folder.write("v.mhd", head), {.names = names}, diagnostics));
  const std::string other =
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 3 2\nspacings: 1 1 1\nencoding: raw\nbyte "
      "skip: 4\ndata file: v.raw\n";
  expect_regions(read_labels(folder.write("v.nhdr", other), {.names = names}, diagnostics));
}

// "byte skip: -1": the voxels are the last bytes, of the inflated data too. Key/value pairs
// ("a:=b") state nothing about the image, and an axis with one entry that is not of space is no
// axis.
TEST(LabelImage, ReadsWhatNrrdAllows) {
  const LabelNames names{{1, "a"}, {2, "a"}, {3, "b"}};
  const std::string bytes = voxels(grid, label_at), before(30, 'h');
  const std::string spacings = "spacings: 1 1 1\n";
  const std::string four_axes =
      "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 1 4 3 2\nkinds: list domain domain domain\n"
      "space directions: none (1,0,0) (0,1,0) (0,0,1)\nencoding: raw\n\n";
  const std::pair<const char*, std::string> files[] = {
      {"raw, at the end", nrrd(grid, spacings + "byte skip: -1\n", before + bytes)},
      {"gzip, at the end",
       nrrd(grid, spacings + "byte skip: -1\n", packed(before + bytes, 31), "gzip")},
      {"gzip, skipped",
       nrrd(grid, spacings + "byte skip: 30\n", packed(before + bytes, 31), "gzip")},
      {"a key and a value", nrrd(grid, spacings + "byte skip:=-1\nsizes:=7\n", bytes)},
      {"a comment", nrrd(grid, spacings + "# sizes: 7\n", bytes)},
      {"byte order mark", "\xef\xbb\xbf" + nrrd(grid, spacings, bytes)},
      {"a list of one", four_axes + bytes},
      {"a spacing of none",
       replaced(replaced(four_axes, "space directions: none (1,0,0) (0,1,0) (0,0,1)",
                         "spacings: nan 1 1 1"),
                "kinds", "labels") +
           bytes}};
  for (const auto& [name, text] : files) {
    SCOPED_TRACE(name);
    const Read read("a.nrrd", text, names);
    expect_regions(read.image);
    EXPECT_TRUE(read.diagnostics.warnings().empty());
  }
}

TEST(LabelImage, WarnsOfBytesBehindTheVoxels) {
  const std::string bytes = voxels(grid, label_at) + "more";
  for (const auto& [name, text] :
       {std::pair{"a.mha", meta(grid, spacing, bytes)},
        std::pair{"a.nrrd", nrrd(grid, "spacings: 1 1 1\n", packed(bytes, 31), "gzip")}}) {
    const Read read(name, text);
    ASSERT_EQ(read.diagnostics.warnings().size(), 1u) << name;
    EXPECT_NE(read.diagnostics.warnings()[0].find("4 bytes follow the 4 x 3 x 2 voxels of uint8"),
              std::string::npos)
        << read.diagnostics.warnings()[0];
  }
}

TEST(LabelImage, LeavesOutLabelsWithoutNames) {
  const Read named("a.mha", meta(grid, spacing, voxels(grid, label_at)), {{2, "two"}});
  ASSERT_EQ(named.diagnostics.notes().size(), 1u);
  EXPECT_NE(named.diagnostics.notes()[0].find("without a name lie outside the body: 1, 3"),
            std::string::npos);
  EXPECT_EQ(std::ranges::count(named.image.region_of, 1), 6);
  const Read all_of_them("a.mha", meta(grid, spacing, voxels(grid, label_at)));
  EXPECT_TRUE(all_of_them.diagnostics.notes().empty());
  EXPECT_EQ(std::ranges::count(all_of_them.image.region_of, 0), 6);
}

TEST(LabelImage, TakesTheScaledValuesOfNifti) {
  test::Nifti nifti{.dim = {3, 4, 3, 2, 1, 1, 1, 1}};
  nifti.slope = 2;
  nifti.intercept = 1;
  const Read read("a.nii", nifti.file(voxels(grid, label_at)), {{5, "two"}});
  EXPECT_EQ(std::ranges::count(read.image.region_of, 1), 6);
  EXPECT_EQ(read.image.region_of[read.image.place(2, 0, 0)], 1);
}

// Voxels have their centres where the file says; places are in m.
TEST(LabelImage, HasItsCornersHalfAVoxelBeforeTheCentres) {
  const Read read(
      "a.mha", meta(grid, "Offset = 10 20 30\nElementSpacing = 2 4 6\n", voxels(grid, label_at)));
  const Vec3 corner = read.image.corner(0, 0, 0), centre = read.image.corner(0.5, 0.5, 0.5);
  EXPECT_NEAR(corner[0], 9e-3, 1e-15);
  EXPECT_NEAR(corner[1], 18e-3, 1e-15);
  EXPECT_NEAR(corner[2], 27e-3, 1e-15);
  EXPECT_NEAR(centre[2], 30e-3, 1e-15);
  EXPECT_NEAR(read.image.voxel_volume(), 48e-9, 1e-20);
}

TEST(LabelImage, SaysWhatIsWrong) {
  const std::string sound = meta(grid, spacing, voxels(grid, label_at));
  EXPECT_NE(error_with("a.mha", sound, {{5, "x"}})
                .find("no voxel has the label 5; the nearest one is 3; the image has 1, 2, 3"),
            std::string::npos);
  const auto nothing = [](double, double, double) { return 0.0; };
  EXPECT_NE(error_with("a.mha", meta(grid, spacing, voxels(grid, nothing)), {{1, "x"}})
                .find("no voxel has the label 1; all voxels are 0"),
            std::string::npos);
  EXPECT_NE(
      error_with("a.mha", meta(grid, spacing, voxels(grid, nothing))).find("all voxels are 0"),
      std::string::npos);
  const auto half = [](double i, double j, double) { return i == 2 && j == 1 ? 0.5 : 1; };
  EXPECT_NE(error_with("a.mha", meta(grid, spacing, voxels<float>(grid, half), "MET_FLOAT"))
                .find("voxel (2, 1, 0) has the value 0.5, but labels are whole numbers"),
            std::string::npos);
  EXPECT_NE(
      error_with("a.mha", sound.substr(0, sound.size() - 1)).find("is shorter than the 4 x 3"),
      std::string::npos);
  const std::string short_data = packed(voxels({4, 3, 1}, label_at), 31);
  EXPECT_NE(error_with("a.nrrd", nrrd(grid, "spacings: 1 1 1\n", short_data, "gzip"))
                .find("is shorter than the 4 x 3"),
            std::string::npos);
  std::string damaged = packed(voxels(grid, label_at), 31);
  damaged[12] = '\xff';
  EXPECT_NE(error_with("a.nrrd", nrrd(grid, "spacings: 1 1 1\n", damaged, "gzip"))
                .find("compressed data is damaged"),
            std::string::npos);
  EXPECT_NE(error_with("a.mha", sound, {}, 10).find("voxels of uint8 need 0 MB of memory, but"),
            std::string::npos);
  const Size scan{5000, 1, 1};
  const auto values = [](double i, double, double) { return i; };
  EXPECT_NE(
      error_with("a.mha", meta(scan, spacing, voxels<std::uint16_t>(scan, values), "MET_USHORT"))
          .find("more than 4,096 different values; give the segmentation"),
      std::string::npos);
}

// A header may promise more than there is memory for.
TEST(LabelImage, TakesNoMemoryForWhatTheFileCannotHold) {
  EXPECT_NE(
      error_with("a.mha", meta({4096, 4096, 4096}, spacing, "\1\1"), {}, 1e15).find("is shorter"),
      std::string::npos);
  EXPECT_NE(
      error_with("a.nrrd",
                 nrrd({4096, 4096, 4096}, "spacings: 1 1 1\n", packed("\1\1", 31), "gzip"), {}, 8e9)
          .find("need 137.4 GB of memory, but 8.0 GB are available"),
      std::string::npos);
}

}  // namespace
}  // namespace suture
