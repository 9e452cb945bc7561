// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "kernel/base/types.hpp"
#include "kernel/images/label_image.hpp"

namespace suture::test {

using Size = std::array<std::uint64_t, 3>;

/// The bytes of voxels of type T, i fastest.
template <class T = std::uint8_t>
std::string voxels(const Size& size, const std::function<double(double, double, double)>& value) {
  std::string bytes;
  for (std::uint64_t k = 0; k < size[2]; ++k)
    for (std::uint64_t j = 0; j < size[1]; ++j)
      for (std::uint64_t i = 0; i < size[0]; ++i) {
        const T stored = static_cast<T>(value(double(i), double(j), double(k)));
        bytes.append(reinterpret_cast<const char*>(&stored), sizeof stored);
      }
  return bytes;
}

inline std::string size_words(const Size& size) {
  return std::to_string(size[0]) + " " + std::to_string(size[1]) + " " + std::to_string(size[2]);
}

/// A .mha of bytes; `keys`: further lines.
inline std::string meta(const Size& size, const std::string& keys, const std::string& bytes,
                        const std::string& type = "MET_UCHAR") {
  return "ObjectType = Image\nNDims = 3\nDimSize = " + size_words(size) + "\n" + keys +
         "ElementType = " + type + "\nElementDataFile = LOCAL\n" + bytes;
}

inline std::string nrrd(const Size& size, const std::string& keys, const std::string& bytes,
                        const std::string& encoding = "raw", const std::string& type = "uchar") {
  return "NRRD0004\n# written by a test\ntype: " + type +
         "\ndimension: 3\nsizes: " + size_words(size) + "\n" + keys +
         "endian: little\nencoding: " + encoding + "\n\n" + bytes;
}

/// What a NIfTI-1 header states; the order of the members is that in the file.
struct Nifti {
  std::array<std::int16_t, 8> dim{3, 1, 1, 1, 1, 1, 1, 1};
  std::int16_t type = 2, bits = 8;
  std::array<float, 8> pixdim{1, 1, 1, 1, 0, 0, 0, 0};
  std::int16_t qform = 0, sform = 0;
  std::array<float, 6> quaternion{};  ///< b, c, d, and the offsets
  std::array<float, 12> rows{};
  float slope = 0, intercept = 0;
  char units = 2;  // mm

  std::string file(const std::string& bytes) const {
    std::string header(352, '\0');
    const auto put = [&](std::size_t at, const auto& value) {
      std::memcpy(header.data() + at, &value, sizeof value);
    };
    put(0, std::int32_t{348});
    put(40, dim);
    put(70, type);
    put(72, bits);
    put(76, pixdim);
    put(108, 352.0f);
    put(112, slope);
    put(116, intercept);
    put(123, units);
    put(252, qform);
    put(254, sform);
    put(256, quaternion);
    put(280, rows);
    header.replace(344, 3, "n+1");
    return header + bytes;
  }
};

/// An image in memory of voxels of 1 m, with the origin at the corner; region 0 is outside.
inline LabelImage image_of(const Size& size,
                           const std::function<double(double, double, double)>& region) {
  LabelImage image;
  image.source = "image";
  image.size = size;
  image.steps = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  for (const char byte : voxels(size, region))
    image.region_of.push_back(static_cast<unsigned char>(byte));
  for (std::uint16_t region_number = 1; region_number <= 2; ++region_number)
    image.regions.push_back(region_number == 1 ? "one" : "two");
  return image;
}

}  // namespace suture::test
