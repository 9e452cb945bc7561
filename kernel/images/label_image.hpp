// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "kernel/base/diagnostics.hpp"
#include "kernel/base/memory.hpp"
#include "kernel/images/image_header.hpp"

namespace suture {

/// The name of the region that a label stands for; several labels may have the same one.
using LabelNames = std::map<std::int64_t, std::string>;

/// An image whose voxels belong to regions.
struct LabelImage {
  std::string source;                   ///< file name, for messages
  std::array<std::uint64_t, 3> size{};  ///< voxels along i (fastest), j and k
  /// The corner (i, j, k) of the voxels, which are parallelepipeds, is at origin + i steps[0] +
  /// j steps[1] + k steps[2], m: voxel (i, j, k) has its lowest corner there.
  Vec3 origin{};
  std::array<Vec3, 3> steps{};
  std::vector<std::string> regions;
  std::vector<std::uint16_t> region_of;  ///< by voxel: 0 outside, n in regions[n - 1]

  std::uint64_t place(std::uint64_t i, std::uint64_t j, std::uint64_t k) const {
    return i + size[0] * (j + size[1] * k);
  }
  Vec3 corner(double i, double j, double k) const;
  double voxel_volume() const;  ///< m^3
};

struct LabelOptions {
  LabelNames names = {};               ///< empty: all labels but 0, as "label 3"
  std::optional<double> scale = {};    ///< m per unit of the file; else as the file states, or mm
  double memory = available_memory();  ///< bytes that may be used
};

/// Reads the voxels whose labels have names. Voxels of labels without a name lie outside; a note
/// lists these labels. Rows of voxels are read and inflated one after the other: needs 2 bytes per
/// voxel, and a note says so for images of more than 100 MB.
///
/// Throws InputError as read_image_header() does, for an image that needs more than the memory
/// there is, a label with a name that no voxel has (gives the nearest one), voxels that are not
/// whole numbers, and a file that is shorter than its header says. Warns of bytes that follow the
/// voxels. 5 ns per voxel.
LabelImage read_labels(const std::filesystem::path& path, const LabelOptions& options,
                       Diagnostics& diagnostics);

/// The number of voxels by label, 0 included. Throws InputError for the same files as
/// read_labels(), but for missing labels.
std::map<std::int64_t, std::uint64_t> count_labels(const ImageHeader& image,
                                                   Diagnostics& diagnostics);

/// "120 x 120 x 80 voxels of int16".
std::string size_text(const ImageHeader& image);

/// Throws InputError if work on an image needs more than the memory there is.
void require_memory(const std::string& source, const std::string& what, double needed,
                    double available);

}  // namespace suture
