// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "kernel/output/output_folder.hpp"
#include "tests/mesh/temporary_folder.hpp"

namespace suture {

inline std::shared_ptr<OutputFolder> output(const std::filesystem::path& path) {
  return std::make_shared<OutputFolder>(path);
}

/// The frames listed in a .pvd file; empty if the file does not exist.
inline std::vector<std::string> frames_in(const std::filesystem::path& list) {
  std::vector<std::string> files;
  const std::string text = std::filesystem::exists(list) ? read_text(list) : "", key = "file=\"";
  for (std::size_t at = 0; (at = text.find(key, at)) != text.npos;) {
    at += key.size();
    files.push_back(text.substr(at, text.find('"', at) - at));
  }
  return files;
}

}  // namespace suture
