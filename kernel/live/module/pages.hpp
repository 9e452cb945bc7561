// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace suture::live {

struct PageFile {
  std::string type;  ///< of its media: "text/html"
  std::string text;
};

/// A file of the page: built in, or below "three/" from the folder of three.js. None if there is no
/// such file.
std::optional<PageFile> page_file(std::string_view name, const std::filesystem::path& three_js);

}  // namespace suture::live
