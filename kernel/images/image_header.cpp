// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernel/images/image_header.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "kernel/base/input_file.hpp"
#include "kernel/base/vec3.hpp"
#include "kernel/images/header_readers.hpp"
#include "kernel/images/voxel_stream.hpp"
#include "kernel/mesh/accepted_as.hpp"

namespace suture {
namespace {

// Headers are far shorter, apart from the comments in some.
constexpr std::size_t longest_header = 100'000;

constexpr double most_voxels = 1e12;  // products of lengths stay exact

std::string lower_name(const std::filesystem::path& path) {
  std::string name = path.filename().string();
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name;
}

void check(const FileHead& head, const ImageHeader& image) {
  const auto& [a, b, c] = image.steps;
  const double volume = std::abs(dot(a, cross(b, c)));
  if (!std::isfinite(volume) || !std::isfinite(norm(image.origin)))
    head.fail("the place of the voxels is not finite");
  if (!(volume > 1e-9 * norm(a) * norm(b) * norm(c)))
    head.fail("the axes of the voxels lie in a plane; check the orientation in the header");
}

}  // namespace

std::size_t bytes_of(VoxelType type) {
  constexpr std::array<std::size_t, 10> bytes{1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return bytes[static_cast<std::size_t>(type)];
}

std::string name_of(VoxelType type) {
  constexpr std::array<const char*, 10> names{"int8",   "uint8", "int16",  "uint16",  "int32",
                                              "uint32", "int64", "uint64", "float32", "float64"};
  return names[static_cast<std::size_t>(type)];
}

std::uint64_t ImageHeader::bytes() const { return size[0] * size[1] * size[2] * bytes_of(type); }

bool is_image_file(const std::filesystem::path& path) {
  return kind_of_file(path) == KindOfFile::image;
}

void set_size(const FileHead& head, const std::vector<double>& lengths, ImageHeader& image) {
  std::string text;
  double voxels = 1;
  for (const double length : lengths) {
    text += (text.empty() ? "" : " x ") + std::to_string(std::llround(length));
    if (!(length >= 1) || length != std::floor(length))
      head.fail("an axis has " + std::to_string(length) + " voxels; expected at least one");
    voxels *= length;
  }
  if (voxels > most_voxels) head.fail("has " + text + " voxels, more than can be read");
  if (lengths.size() < 3) head.fail("has " + text + " voxels; an image of three axes is needed");
  if (std::any_of(lengths.begin() + 3, lengths.end(), [](double length) { return length != 1; }))
    head.fail("has " + std::to_string(lengths.size()) + " axes (" + text +
              "); save one image of three axes, such as one time step");
  for (std::size_t a = 0; a < 3; ++a) image.size[a] = static_cast<std::uint64_t>(lengths[a]);
}

void fail_without_spacing(const FileHead& head, const char* key) {
  head.fail(std::string("the header states no spacing, so the size of the body is unknown; add '") +
            key + "', or save the image again with its spacing");
}

void fail_with_components(const FileHead& head, double components) {
  head.fail("has " + std::to_string(std::llround(components)) +
            " values per voxel, such as colours; labels are one whole number per voxel");
}

std::array<Vec3, 3> straight_steps(const FileHead& head, const std::vector<double>& spacing,
                                   const char* key) {
  std::array<Vec3, 3> steps{};
  for (std::size_t a = 0; a < 3; ++a) {
    if (a >= spacing.size() || !std::isfinite(spacing[a]) || spacing[a] == 0)
      fail_without_spacing(head, key);
    steps[a][a] = std::abs(spacing[a]);
  }
  return steps;
}

ImageHeader read_image_header(const std::filesystem::path& path) {
  FileHead head{path, {}, false};
  VoxelStream stream(path);
  head.is_gzip = stream.is_gzip();
  if (head.is_gzip) stream.inflate();
  head.text.resize(longest_header);
  head.text.resize(stream.read_some(head.text));
  if (head.text.empty()) head.fail("the file is empty");
  const std::string name = lower_name(path);
  ImageHeader image = name.ends_with(".mha") || name.ends_with(".mhd") ? read_meta_header(head)
                      : head.text.compare(byte_order_mark(head.text), 4, "NRRD") == 0
                          ? read_nrrd_header(head)
                          : read_nifti_header(head);
  image.source = path.string();
  check(head, image);
  return image;
}

}  // namespace suture
