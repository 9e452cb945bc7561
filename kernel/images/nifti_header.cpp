// SPDX-License-Identifier: GPL-3.0-or-later
//
// NIfTI-1 (348 bytes) and NIfTI-2 (540 bytes): nifti1.h and nifti2.h of nifti.nimh.nih.gov.
#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "kernel/base/vec3.hpp"
#include "kernel/images/header_readers.hpp"
#include "kernel/images/voxel_bytes.hpp"
#include "kernel/mesh/accepted_as.hpp"

namespace suture {
namespace {

/// Where the fields are, by version.
struct Layout {
  std::size_t bytes, magic, dimensions, spacing, type, voxels, slope, codes, quaternion, rows,
      units;
};
constexpr Layout version_1{348, 344, 40, 76, 70, 108, 112, 252, 256, 280, 123};
constexpr Layout version_2{540, 4, 16, 104, 12, 168, 176, 344, 352, 400, 500};

class NiftiReader {
 public:
  explicit NiftiReader(const FileHead& head) : head_(head) {
    for (const Layout& layout : {version_1, version_2})
      for (const bool is_swapped : {false, true}) {
        if (head.text.size() < layout.bytes) continue;
        is_swapped_ = is_swapped;
        if (get<std::int32_t>(0) != static_cast<std::int32_t>(layout.bytes)) continue;
        at_ = layout;
        is_second_ = layout.bytes == version_2.bytes;
        return;
      }
    head.fail(
        "not a label image; expected NIfTI .nii or .nii.gz, MetaImage .mha or .mhd, or NRRD "
        ".nrrd or .nhdr" +
        accepted_as(head.path));
  }

  ImageHeader read() {
    const std::string magic = head_.text.substr(at_.magic, 3);
    if (magic == "ni1" || magic == "ni2")
      head_.fail("the voxels are in a second file .img; save the image as one .nii");
    if (magic != "n+1" && magic != "n+2") head_.fail("not NIfTI: the header has no mark 'n+1'");
    ImageHeader image;
    image.data = head_.path;
    image.packing = head_.is_gzip ? ImageHeader::Packing::deflated : ImageHeader::Packing::raw;
    image.is_big_endian = is_swapped_ == (std::endian::native == std::endian::little);
    image.type = type();
    set_size(head_, lengths(), image);
    place(image);
    const double skipped = is_second_ ? double(get<std::int64_t>(at_.voxels)) : real(at_.voxels);
    if (!(skipped >= double(at_.bytes) && skipped <= 1e9))
      head_.fail("the header says that the voxels begin at byte " + std::to_string(skipped));
    image.skipped = static_cast<std::uint64_t>(skipped);
    if (const double slope = real(at_.slope, 0); slope != 0 && std::isfinite(slope)) {
      image.slope = slope;
      image.intercept = real(at_.slope, 1);
    }
    return image;
  }

 private:
  template <class T>
  T get(std::size_t at) const {
    return load<T>(head_.text.data() + at, is_swapped_);
  }
  /// Element i of an array of float (version 1) or double.
  double real(std::size_t at, std::size_t i = 0) const {
    return is_second_ ? get<double>(at + 8 * i) : double(get<float>(at + 4 * i));
  }
  double dimension(std::size_t i) const {
    return is_second_ ? double(get<std::int64_t>(at_.dimensions + 8 * i))
                      : double(get<std::int16_t>(at_.dimensions + 2 * i));
  }
  int code(std::size_t i) const {
    return is_second_ ? get<std::int32_t>(at_.codes + 4 * i) : get<std::int16_t>(at_.codes + 2 * i);
  }

  std::vector<double> lengths() const {
    const double axes = dimension(0);
    if (!(axes >= 1 && axes <= 7))
      head_.fail("the header states " + std::to_string(axes) + " axes");
    std::vector<double> result;
    for (std::size_t a = 1; a <= static_cast<std::size_t>(axes); ++a)
      result.push_back(dimension(a));
    return result;
  }

  VoxelType type() const {
    const int number = get<std::int16_t>(at_.type);
    switch (number) {
      case 2:
        return VoxelType::uint8;
      case 4:
        return VoxelType::int16;
      case 8:
        return VoxelType::int32;
      case 16:
        return VoxelType::float32;
      case 64:
        return VoxelType::float64;
      case 128:
        fail_with_components(head_, 3);
      case 256:
        return VoxelType::int8;
      case 512:
        return VoxelType::uint16;
      case 768:
        return VoxelType::uint32;
      case 1024:
        return VoxelType::int64;
      case 1280:
        return VoxelType::uint64;
      case 2304:
        fail_with_components(head_, 4);
      default:
        head_.fail("voxels of the NIfTI type " + std::to_string(number) +
                   " are not read; save labels as integers");
    }
  }

  /// By the sform, else the qform, else the spacing alone.
  void place(ImageHeader& image) const {
    const int spatial_unit = (is_second_ ? get<std::int32_t>(at_.units)
                                         : static_cast<unsigned char>(head_.text[at_.units])) &
                             7;
    image.unit = spatial_unit == 1 ? 1 : spatial_unit == 3 ? 1e-6 : 1e-3;
    if (code(1) > 0) {
      for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t a = 0; a < 3; ++a) image.steps[a][r] = real(at_.rows, 4 * r + a);
        image.origin[r] = real(at_.rows, 4 * r + 3);
      }
      return;
    }
    std::vector<double> spacing;
    for (std::size_t a = 1; a <= 3; ++a) spacing.push_back(real(at_.spacing, a));
    image.steps = straight_steps(head_, spacing, "pixdim");
    if (code(0) > 0) turn(image);
  }

  /// The unit quaternion (a, b, c, d), a >= 0, as a rotation; pixdim[0] < 0 reverses k.
  void turn(ImageHeader& image) const {
    Vec3 v{real(at_.quaternion, 0), real(at_.quaternion, 1), real(at_.quaternion, 2)};
    const double squared = 1 - dot(v, v);
    const bool is_half_turn = squared < 1e-7;  // a rounds to more than 1e-4
    if (is_half_turn) v = scaled(1 / norm(v), v);
    const double a = is_half_turn ? 0 : std::sqrt(squared);
    const auto& [b, c, d] = v;
    const std::array<Vec3, 3> axes{
        Vec3{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)},
        Vec3{2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)},
        Vec3{2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - b * b - c * c}};
    for (std::size_t i = 0; i < 3; ++i) {
      const double length = image.steps[i][i] * (i == 2 && real(at_.spacing) < 0 ? -1 : 1);
      for (std::size_t r = 0; r < 3; ++r) image.steps[i][r] = length * axes[i][r];
      image.origin[i] = real(at_.quaternion, 3 + i);
    }
  }

  const FileHead& head_;
  Layout at_{};
  bool is_swapped_ = false, is_second_ = false;
};

}  // namespace

ImageHeader read_nifti_header(const FileHead& head) { return NiftiReader(head).read(); }

}  // namespace suture
