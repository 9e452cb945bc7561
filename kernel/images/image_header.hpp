// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "kernel/base/types.hpp"

namespace suture {

enum class VoxelType : std::uint8_t {
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64
};

/// What the file of an image states besides its voxels.
struct ImageHeader {
  enum class Packing { raw, deflated };

  std::string source;                   ///< file name, for messages
  std::array<std::uint64_t, 3> size{};  ///< voxels along i (fastest), j and k
  VoxelType type = VoxelType::uint8;
  bool is_big_endian = false;
  double slope = 1, intercept = 0;  ///< the value of a voxel is slope * stored + intercept
  /// The centre of voxel (i, j, k) is origin + i steps[0] + j steps[1] + k steps[2], in the unit of
  /// the file.
  Vec3 origin{};
  std::array<Vec3, 3> steps{};
  double unit = 1e-3;  ///< m; that of the file if it states one

  std::filesystem::path data;  ///< the file with the voxels
  Packing packing = Packing::raw;
  /// Bytes before the voxels: of the data once inflated, if they are packed.
  std::uint64_t skipped = 0;
  /// Bytes before the packed data.
  std::uint64_t packed_from = 0;
  /// The voxels are the last bytes of the file, or of the inflated data, instead of `skipped`.
  bool is_at_end = false;

  double voxels() const { return double(size[0]) * double(size[1]) * double(size[2]); }
  std::uint64_t bytes() const;  ///< of all voxels
};

std::size_t bytes_of(VoxelType type);
/// "int16".
std::string name_of(VoxelType type);

/// Whether a file has the extension of an image: .nii, .nii.gz, .mha, .mhd, .nrrd, .nhdr.
bool is_image_file(const std::filesystem::path& path);

/// Reads the header of a NIfTI-1 or -2 (`.nii`, `.nii.gz`), MetaImage (`.mha`, `.mhd`) or NRRD
/// (`.nrrd`, `.nhdr`) file. Of NIfTI, the sform counts, or the qform, or the spacing alone; of
/// MetaImage, TransformMatrix, Offset and ElementSpacing; of NRRD, the space directions and origin,
/// or the spacings. Places are those of the file, without a change of axes.
///
/// Throws InputError for a file that is missing, malformed or of another format, for images with
/// another number of axes than three, several values per voxel (RGB), no spacing, axes that lie in
/// a plane, and kinds of data that are not read (text, bzip2, lists of files). Only the first
/// 100 kB of the file are read.
ImageHeader read_image_header(const std::filesystem::path& path);

}  // namespace suture
