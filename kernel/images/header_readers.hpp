// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "kernel/base/error.hpp"
#include "kernel/images/image_header.hpp"

// The readers behind read_image_header(), one per format.

namespace suture {

/// The first bytes of an image file, inflated if the file is a gzip.
struct FileHead {
  std::filesystem::path path;
  std::string text;
  bool is_gzip = false;

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(path.string() + ": " + what);
  }
};

ImageHeader read_nifti_header(const FileHead& head);
ImageHeader read_meta_header(const FileHead& head);
ImageHeader read_nrrd_header(const FileHead& head);

/// Sets the size. Throws InputError unless there are three axes; more are allowed if they have the
/// length 1.
void set_size(const FileHead& head, const std::vector<double>& lengths, ImageHeader& image);

/// The steps along the axes of the scene. Throws InputError for a spacing that is 0 or not finite,
/// which is how files say that they have none; `key`: what would state it.
std::array<Vec3, 3> straight_steps(const FileHead& head, const std::vector<double>& spacing,
                                   const char* key);

[[noreturn]] void fail_without_spacing(const FileHead& head, const char* key);
[[noreturn]] void fail_with_components(const FileHead& head, double components);

}  // namespace suture
