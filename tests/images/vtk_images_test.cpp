// SPDX-License-Identifier: GPL-3.0-or-later
//
// Images as VTK writes them.
#include <gtest/gtest.h>
#include <vtkImageData.h>
#include <vtkMatrix4x4.h>
#include <vtkMetaImageWriter.h>
#include <vtkNIFTIImageWriter.h>
#include <vtkNew.h>

#include <cmath>
#include <random>

#include "kernel/images/label_image.hpp"
#include "tests/mesh/temporary_folder.hpp"

namespace suture {
namespace {

/// Random labels 0, 1, 2 in 7 x 5 x 4 voxels of 0.5 x 1 x 2 mm.
vtkNew<vtkImageData> random_image(int type) {
  vtkNew<vtkImageData> image;
  image->SetDimensions(7, 5, 4);
  image->SetSpacing(0.5, 1, 2);
  image->AllocateScalars(type, 1);
  std::mt19937 random(5);
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 7; ++i) image->SetScalarComponentFromDouble(i, j, k, 0, random() % 3);
  return image;
}

void expect_same(const LabelImage& image, vtkImageData* written) {
  ASSERT_EQ(image.size, (std::array<std::uint64_t, 3>{7, 5, 4}));
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 7; ++i)
        EXPECT_EQ(
            image.region_of[image.place(std::uint64_t(i), std::uint64_t(j), std::uint64_t(k))],
            written->GetScalarComponentAsDouble(i, j, k, 0));
}

const LabelOptions options{.names = {{1, "a"}, {2, "b"}}, .scale = 1};

TEST(VtkImages, NiftiWithItsOrientation) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  // Turned by 30 degrees about x, and moved.
  const double c = std::cos(0.5), s = std::sin(0.5);
  const double elements[16] = {1, 0, 0, 10, 0, c, -s, 20, 0, s, c, 30, 0, 0, 0, 1};
  vtkNew<vtkMatrix4x4> turn;
  turn->DeepCopy(elements);
  for (const char* name : {"a.nii", "b.nii.gz"})
    for (const int type : {VTK_UNSIGNED_CHAR, VTK_SHORT, VTK_INT, VTK_FLOAT, VTK_DOUBLE})
      for (const bool by_quaternion : {false, true}) {
        const auto image = random_image(type);
        vtkNew<vtkNIFTIImageWriter> writer;
        if (by_quaternion)
          writer->SetQFormMatrix(turn);
        else
          writer->SetSFormMatrix(turn);
        writer->SetInputData(image);
        writer->SetFileName((folder / name).c_str());
        writer->Write();
        const LabelImage read = read_labels(folder / name, options, diagnostics);
        expect_same(read, image);
        const Vec3 place = read.corner(2.5, 3.5, 1.5);  // the centre of voxel (2, 3, 1)
        EXPECT_NEAR(place[0], 10 + 1, 1e-5);
        EXPECT_NEAR(place[1], 20 + 3 * c - 2 * s, 1e-5);
        EXPECT_NEAR(place[2], 30 + 3 * s + 2 * c, 1e-5);
      }
}

TEST(VtkImages, MetaImage) {
  const TemporaryFolder folder;
  Diagnostics diagnostics;
  for (const char* name : {"a.mha", "b.mhd"})
    for (const bool is_packed : {false, true})
      for (const int type : {VTK_UNSIGNED_CHAR, VTK_UNSIGNED_SHORT, VTK_INT, VTK_FLOAT}) {
        const auto image = random_image(type);
        image->SetOrigin(1, 2, 3);
        vtkNew<vtkMetaImageWriter> writer;
        writer->SetInputData(image);
        writer->SetFileName((folder / name).c_str());
        writer->SetCompression(is_packed);
        writer->Write();
        const LabelImage read = read_labels(folder / name, options, diagnostics);
        expect_same(read, image);
        const Vec3 place = read.corner(2.5, 3.5, 1.5);
        EXPECT_NEAR(place[0], 1 + 1, 1e-12);
        EXPECT_NEAR(place[1], 2 + 3, 1e-12);
        EXPECT_NEAR(place[2], 3 + 2, 1e-12);
      }
}

}  // namespace
}  // namespace suture
